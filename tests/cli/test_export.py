"""``export``: models that other programs read, of the robot in the pose that was asked for."""

from __future__ import annotations

import io
import json
import struct
import xml.etree.ElementTree as ET
import zipfile
from pathlib import Path

import numpy as np
import pytest

from paminsa_viz.cli import main
from paminsa_viz.engines.poses import start_pose
from paminsa_viz.files.design_file import save_design
from paminsa_viz.model import APPENDIX_4, KneeBranch
from tests.support.samples import with_knee


def glb_pose(path: str) -> dict[str, float]:
    data = Path(path).read_bytes()
    (length,) = struct.unpack("<I", data[12:16])
    return json.loads(data[20 : 20 + length])["scenes"][0]["extras"]["pose"]


def refs(text: bytes) -> dict[str, float]:
    """Where the platform's joints stand at the start, by name."""
    joints = ET.fromstring(text).iter("joint")
    return {
        j.attrib["name"][9:]: float(j.attrib["ref"])
        for j in joints
        if "platform" in j.attrib["name"]
    }


def test_everything_at_once_in_one_pose(capsys) -> None:
    words = "--glb r.glb --mjcf r.xml --meshes m --pose 50 -30 20 -550"
    assert main(["export", *words.split()]) == 0
    wanted = {"x": 0.05, "y": -0.03, "theta": np.radians(20), "z": -0.55}
    assert glb_pose("r.glb") == pytest.approx(wanted)
    for name in ("r.xml", "m/robot.xml"):
        found = refs(Path(name).read_bytes())
        assert {key: found[key] for key in wanted} == pytest.approx(wanted)
    meshes = list(Path("m/meshes").glob("*.obj"))
    assert len(meshes) > 40
    said = capsys.readouterr().out.splitlines()
    assert said == ["r.glb: written", "r.xml: written", f"m: written, {len(meshes) + 1} files"]


def test_another_design_and_assembly_as_zip_with_motors() -> None:
    design = APPENDIX_4.vary({"payload.mass": 3.25, "geometry.crank_length": 0.44})
    save_design(design, "d.toml")
    words = "--meshes big.zip --design d.toml --assembly mirror --motors"
    assert main(["export", *words.split()]) == 0
    with zipfile.ZipFile(io.BytesIO(Path("big.zip").read_bytes())) as archive:
        text = archive.read("big/robot.xml")
    root = ET.fromstring(text)
    payload = root.find(".//body[@name='payload']/inertial")
    assert payload is not None
    assert float(payload.attrib["mass"]) == 3.25
    assert refs(text)["z"] == start_pose(with_knee(design, KneeBranch.UPPER))[3]
    assert [a.tag for a in root.find("actuator") or []] == ["motor"] * 4


def test_servos_are_the_default() -> None:
    assert main(["export", "--mjcf", "r.xml"]) == 0
    root = ET.fromstring(Path("r.xml").read_bytes())
    assert [a.tag for a in root.find("actuator") or []] == ["general"] * 4
