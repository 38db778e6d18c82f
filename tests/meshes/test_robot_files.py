"""The MuJoCo model with meshes: the same mechanics, with every shape in its place."""

from __future__ import annotations

import io
import xml.etree.ElementTree as ET
import zipfile
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import trimesh
from scipy.spatial import cKDTree

from paminsa_viz.engines.exported import exported_mjcf
from paminsa_viz.engines.mjcf import mjcf_text
from paminsa_viz.engines.poses import joint_values
from paminsa_viz.files.archives import zipped
from paminsa_viz.meshes import assemble_glb
from paminsa_viz.meshes.robot_files import robot_files
from paminsa_viz.model import APPENDIX_4, Design, InvalidInput, KneeBranch, inverse_kinematics
from paminsa_viz.model.parameters import Counterweight
from tests.support import samples

LOADED = APPENDIX_4.vary({"payload.mass": 2.0})
LONGER = LOADED.vary({"geometry.shaft_length": 0.5})
START = (0.06, -0.04, 0.3, -0.55)
ELSEWHERE = (-0.05, 0.05, -0.2, -0.63)


def standing(pose: tuple[float, ...], knee: KneeBranch) -> list[float]:
    return [*pose[:3], pose[3] * knee.sign]


def files_of(
    design: Design = LOADED, pose: tuple[float, ...] = START, text: str = ""
) -> dict[str, bytes]:
    place = standing(pose, design.geometry.knee)
    text = text or mjcf_text(design, pose=place)
    return robot_files(text, design, inverse_kinematics(design.geometry, place))


@pytest.fixture(scope="module")
def files() -> dict[str, bytes]:
    return files_of()


def written(files: dict[str, bytes], folder: Path) -> str:
    (folder / "meshes").mkdir()
    for name, content in files.items():
        (folder / name).write_bytes(content)
    return str(folder / "robot.xml")


@pytest.fixture(scope="module", params=list(KneeBranch), ids=lambda knee: knee.value)
def exported(
    request: pytest.FixtureRequest, mujoco: Any, tmp_path_factory: pytest.TempPathFactory
) -> tuple[Design, Any]:
    """A design of either knee, with the upper one of another size, and its model."""
    size = 1.0 if request.param is KneeBranch.LOWER else 0.8
    design = LOADED.vary({"geometry.body_scale": size}).with_knee(request.param)
    text = exported_mjcf(design, pose=standing(START, request.param))
    folder = tmp_path_factory.mktemp("exported")
    return design, mujoco.MjModel.from_xml_path(written(files_of(design, text=text), folder))


@pytest.mark.slow
def test_model_loads_and_steps_two_seconds_without_a_warning(
    mujoco: Any, exported: tuple[Design, Any]
) -> None:
    _, model = exported
    data = mujoco.MjData(model)
    for _ in range(round(2.0 / model.opt.timestep)):
        mujoco.mj_step(model, data)
    assert data.time == pytest.approx(2.0)
    assert not any(warning.number for warning in data.warning)
    np.testing.assert_allclose(data.qpos, model.qpos0, rtol=0, atol=1e-4)


@pytest.mark.slow
def test_meshes_change_nothing_of_the_mechanics(mujoco: Any, tmp_path: Path) -> None:
    design = samples.random_design(np.random.default_rng(5))
    pose = tuple(samples.random_poses(np.random.default_rng(6), design)[0].tolist())
    plain = mujoco.MjModel.from_xml_string(mjcf_text(design, pose=pose))
    files = files_of(design, pose=pose)
    shown = mujoco.MjModel.from_xml_path(written(files, tmp_path))
    for field in ("body_mass", "body_inertia", "body_ipos", "body_pos", "jnt_axis", "eq_data"):
        assert np.array_equal(getattr(plain, field), getattr(shown, field)), field
    assert not shown.geom_contype.any()
    assert not shown.geom_conaffinity.any()
    mesh = shown.geom_type == mujoco.mjtGeom.mjGEOM_MESH
    assert shown.nmesh > 40
    # What a viewer shows by default is the meshes and nothing else.
    assert (shown.geom_group[mesh] == 1).all()
    assert (shown.geom_group[~mesh] == 3).all()
    assert (~mesh).sum() == plain.ngeom


def drawn(mujoco: Any, model: Any, data: Any) -> dict[str, np.ndarray]:
    """Vertices in the world by the drawn body's name, as in the GLB."""
    found: dict[str, list[np.ndarray]] = {}
    for geom in range(model.ngeom):
        if model.geom_type[geom] != mujoco.mjtGeom.mjGEOM_MESH:
            continue
        mesh = int(model.geom_dataid[geom])
        first, count = model.mesh_vertadr[mesh], model.mesh_vertnum[mesh]
        local = model.mesh_vert[first : first + count]
        world = local @ data.geom_xmat[geom].reshape(3, 3).T + data.geom_xpos[geom]
        name = model.mesh(mesh).name.rpartition(".")[0]
        carrier = model.body(model.geom_bodyid[geom]).name
        if name.startswith("leg"):
            name = name.replace(".", "_")
        elif carrier.startswith("leg"):
            name = f"{carrier[:4]}_{name}"
        found.setdefault(name, []).append(world)
    return {name: np.concatenate(parts) for name, parts in found.items()}


@pytest.mark.slow
def test_every_shape_is_where_the_robot_has_it_in_another_pose(
    mujoco: Any, exported: tuple[Design, Any]
) -> None:
    """Against the GLB of that pose: no vertex of either is missing in the other."""
    design, model = exported
    data = mujoco.MjData(model)
    pose = standing(ELSEWHERE, design.geometry.knee)
    configuration = inverse_kinematics(design.geometry, pose)
    values = joint_values(configuration)
    data.qpos[:] = [float(values[model.joint(i).name]) for i in range(model.njnt)]
    mujoco.mj_kinematics(model, data)
    found = drawn(mujoco, model, data)
    scene = trimesh.load_scene(io.BytesIO(assemble_glb(design, configuration)), file_type="glb")
    expected: dict[str, list[np.ndarray]] = {}
    for node in scene.graph.nodes_geometry:
        matrix, mesh = scene.graph.get(node)
        points = trimesh.transform_points(scene.geometry[mesh].vertices, matrix)
        body = node.rpartition(".")[0]
        expected.setdefault(body, []).append(points @ np.array([[1, 0, 0], [0, 0, 1], [0, -1, 0]]))
    heads = {name for name in found if "swivel" in name}
    assert len(heads) == 6
    assert set(found) - heads == {name for name in expected if "swivel" not in name}
    for name in set(found) - heads:
        whole = np.concatenate(expected[name])
        assert cKDTree(whole).query(found[name])[0].max() < 1e-6, name
        assert cKDTree(found[name]).query(whole)[0].max() < 1e-6, name
    for leg in (1, 2, 3):
        # Swivels turn with no body of the mechanics: they stay together at joint 5.
        joint = configuration.points[5][leg - 1]
        head = found[f"leg{leg}_swivel_head"]
        assert np.linalg.norm(head - joint, axis=1).max() < 0.07
        reach = np.linalg.norm(np.concatenate(expected[f"leg{leg}_swivel"]) - joint, axis=1).max()
        assert np.linalg.norm(head - joint, axis=1).max() == pytest.approx(reach, abs=1e-5)


@pytest.mark.slow
def test_counterweights_stay_visible_and_change_no_mesh(files: dict[str, bytes]) -> None:
    weighed = files_of(replace(LOADED, counterweights=(Counterweight("b8", 8, 0.1, 0.5),)))
    root = ET.fromstring(weighed.pop("robot.xml"))
    assert weighed == {name: content for name, content in files.items() if name != "robot.xml"}
    found = [b for b in root.iter("body") if "counterweight" in b.attrib["name"]]
    assert len(found) == 3
    assert all(g.get("group") is None for b in found for g in b.iter("geom"))


@pytest.mark.slow
def test_every_mesh_is_named_and_used_and_bars_have_the_colors_of_their_legs(
    files: dict[str, bytes],
) -> None:
    root = ET.fromstring(files["robot.xml"])
    meshes = {mesh.attrib["name"]: mesh.attrib["file"] for mesh in root.iterfind("asset/mesh")}
    assert {f"meshes/{file}" for file in meshes.values()} == set(files) - {"robot.xml"}
    assert {geom.attrib["mesh"] for geom in root.iter("geom") if "mesh" in geom.attrib} == {*meshes}
    color = {m.attrib["name"]: m.attrib["rgba"] for m in root.iterfind("asset/material")}
    bars = root.findall(".//geom[@mesh='b4.accent']")
    assert [color[bar.attrib["material"]] for bar in bars] == [
        "0 0.4471 0.698 1", "0.8353 0.3686 0 1", "0 0.6196 0.451 1",
    ]  # fmt: skip


@pytest.mark.slow
def test_a_zip_holds_all_in_one_folder_and_repeats(files: dict[str, bytes]) -> None:
    packed = zipped(files, "robot")
    assert packed == zipped(files, "robot")
    with zipfile.ZipFile(io.BytesIO(packed)) as archive:
        assert archive.testzip() is None
        assert {n: archive.read(f"robot/{n}") for n in files} == files


@pytest.mark.parametrize(
    ("argument", "text", "design"),
    [
        ("text", mjcf_text(LOADED, pose=standing(ELSEWHERE, KneeBranch.LOWER)), LOADED),
        ("text", "<mujoco/>", LOADED),
        ("configuration", mjcf_text(LOADED, pose=START), LONGER),
    ],
    ids=["another pose", "empty", "another geometry"],
)
def test_a_text_of_another_robot_or_pose_is_refused(
    argument: str, text: str, design: Design
) -> None:
    with pytest.raises(InvalidInput) as caught:
        robot_files(text, LOADED, inverse_kinematics(design.geometry, START))
    assert caught.value.argument == argument
