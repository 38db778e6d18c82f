"""``export``: models that other programs read, of the robot at a pose."""

from __future__ import annotations

import json
import struct
import xml.etree.ElementTree as ET
import zipfile
from pathlib import Path

import numpy as np
import pytest

from paminsa_viz.engines.dxf import dxf_text
from paminsa_viz.engines.exported import exported_usd
from paminsa_viz.engines.urdf import closure_table, urdf_text
from paminsa_viz.files.design_file import save_design
from paminsa_viz.model import APPENDIX_4, KneeBranch, home_pose
from tests.support.commands import check_refused, run
from tests.support.samples import with_knee


def glb_pose(path: str) -> dict[str, float]:
    data = Path(path).read_bytes()
    (length,) = struct.unpack("<I", data[12:16])
    return json.loads(data[20 : 20 + length])["scenes"][0]["extras"]["pose"]


def refs(text: bytes) -> dict[str, float]:
    """The platform's joint values at the start, by name."""
    joints = ET.fromstring(text).iter("joint")
    return {
        j.attrib["name"][9:]: float(j.attrib["ref"])
        for j in joints
        if "platform" in j.attrib["name"]
    }


def actuators(text: bytes) -> list[str]:
    return [actuator.tag for actuator in ET.fromstring(text).iterfind("actuator/*")]


@pytest.mark.slow
def test_everything_at_once_at_one_pose(capsys) -> None:
    words = "--glb r.glb --mjcf r.xml --meshes m --pose 50 -30 20 -550"
    code, out, _ = run("export", capsys, *words.split())
    meshes = list(Path("m/meshes").glob("*.obj"))
    assert len(meshes) > 40
    files = f"r.glb: written\nr.xml: written\nm: written, {len(meshes) + 1} files\n"
    assert (code, out) == (0, files)
    wanted = {"x": 0.05, "y": -0.03, "theta": np.radians(20), "z": -0.55}
    assert glb_pose("r.glb") == pytest.approx(wanted)
    for name in ("r.xml", "m/robot.xml"):
        text = Path(name).read_bytes()
        assert {key: refs(text)[key] for key in wanted} == pytest.approx(wanted)
        assert actuators(text) == ["general"] * 4


@pytest.mark.slow
def test_another_design_and_branch_as_zip_with_motors(capsys) -> None:
    design = APPENDIX_4.vary({"payload.mass": 3.25, "geometry.crank_length": 0.44})
    save_design(design, "d.toml")
    words = "--meshes big.zip --design d.toml --knee upper --motors"
    assert run("export", capsys, *words.split())[0] == 0
    with zipfile.ZipFile("big.zip") as archive:
        text = archive.read("big/robot.xml")
    payload = ET.fromstring(text).find(".//body[@name='payload']/inertial")
    assert payload is not None
    assert float(payload.attrib["mass"]) == 3.25
    assert refs(text)["z"] == home_pose(with_knee(design, KneeBranch.UPPER))[3]
    assert actuators(text) == ["motor"] * 4


def test_without_a_pose_it_is_the_one_of_other_commands(capsys) -> None:
    """Torques that are printed at home are compared with a model that starts there."""
    assert run("export", capsys, "--dxf", "r.dxf")[0] == 0
    at_home = dxf_text(APPENDIX_4, pose=home_pose(APPENDIX_4.geometry))
    assert Path("r.dxf").read_text() == at_home


def test_usd_urdf_and_dxf_at_a_pose(capsys) -> None:
    design = APPENDIX_4.vary({"payload.mass": 3.25})
    save_design(design, "d.toml")
    words = "--usd r.usda --urdf r.urdf --dxf r.dxf --design d.toml --pose 50 -30 20 -550"
    code, out, err = run("export", capsys, *words.split())
    names = ("r.usda", "r.urdf", "r.loops.json", "r.dxf")
    assert (code, out, err) == (0, "".join(f"{name}: written\n" for name in names), "")
    pose = [0.05, -0.03, float(np.radians(20)), -0.55]
    assert Path("r.usda").read_text() == exported_usd(design, pose=pose)
    assert Path("r.urdf").read_text() == urdf_text(design)
    assert json.loads(Path("r.loops.json").read_text()) == closure_table(design)
    assert Path("r.dxf").read_text() == dxf_text(design, pose=pose)


@pytest.mark.slow
@pytest.mark.parametrize("deviation", [0.0, 1e-4])
def test_every_file_says_what_it_leaves_out_of_the_legs(deviation: float, capsys) -> None:
    design = APPENDIX_4.vary({"leg2.bar_94": deviation})
    save_design(design, "d.toml")
    words = "--glb r.glb --mjcf r.xml --usd r.usda --urdf r.urdf --dxf r.dxf --design d.toml"
    code, out, _ = run("export", capsys, *words.split())
    assert code == 0
    note = "legs are equal, the design's deviations of single legs are left out"
    assert (out.splitlines()[-1] == note) == (deviation != 0)
    for name in ("r.glb", "r.xml", "r.usda", "r.urdf", "r.dxf"):
        assert (note.encode() in Path(name).read_bytes()) == (deviation != 0), name


def test_motors_leave_usd_without_servos(capsys) -> None:
    assert run("export", capsys, "--usd", "r.usda", "--motors")[0] == 0
    home = home_pose(APPENDIX_4.geometry)
    assert Path("r.usda").read_text() == exported_usd(APPENDIX_4, pose=home, servos=False)


@pytest.mark.parametrize(
    ("words", "place"),
    [
        ("", "give --glb, --mjcf, --usd, --urdf, --dxf or --meshes"),
        ("--usd r.usd", "--usd r.usd: its ending has to be .usda"),
        ("--urdf missing/r.urdf", "missing/r.urdf: cannot be written"),
        ("--dxf r.dxf --pose 2000 0 0 -500", "pose"),
        ("--dxf r.dxf --urdf taken.urdf", "taken.loops.json: cannot be written"),
        ("--usd r.usda --design light.toml", "leg1_slider with its joints has 0 kg"),
        ("--urdf r.urdf --design light.toml", "leg1_slider with its joints has 0 kg"),
    ],
)
def test_nothing_is_written_of_what_cannot_be(words: str, place: str, capsys) -> None:
    Path("taken.loops.json").mkdir()
    save_design(APPENDIX_4.vary({"joints.j8": 0.0}), "light.toml")
    check_refused("export", capsys, *words.split(), place=place)
