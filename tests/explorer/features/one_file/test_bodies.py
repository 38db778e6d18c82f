"""Bodies of the page in one file, stretched and placed in JavaScript, are those of `meshes`."""

from __future__ import annotations

import shutil
from pathlib import Path

import numpy as np
import pytest

from paminsa_viz.dimensions.placement import BODIES, place_parts
from paminsa_viz.explorer.state.document import Document
from paminsa_viz.meshes.bodies import STANDING, make_body
from paminsa_viz.meshes.loads import payload_transform
from paminsa_viz.meshes.part import fixed_part
from paminsa_viz.meshes.solids import plain_shapes
from paminsa_viz.model import APPENDIX_4, Design, KneeBranch, inverse_kinematics
from paminsa_viz.model.arrays import Array
from tests.explorer.features.one_file.node import run_in_node
from tests.support.samples import enlarged, random_design, random_poses

POSE = (0.08, 0.05, np.pi / 3, -0.55)

RUN = """
return given.map((text) => {
  const doc = checkedDocument(text);
  const robot = robotOf(doc);
  const lengths = bodyLengths(robot);
  const solved = solvePose(robot, doc.pose);
  return placedBodies(robot, doc.pose, solved).map(({ body, accent, matrix: m }) => {
    const points = stretched(BODIES[body], lengths);
    const placed = [];
    for (let at = 0; at < points.length; at += 3) {
      const [x, y, z] = points.subarray(at, at + 3);
      for (let row = 0; row < 3; row++)
        placed.push(m[row] * x + m[4 + row] * y + m[8 + row] * z + m[12 + row]);
    }
    return [body, accent, placed];
  });
});
"""


def points_in_javascript(documents: list[Document], folder: Path) -> list[dict[str, Array]]:
    """Return the points of all bodies in the world frame by their names in Python, (n, 3) [m]."""
    found = []
    for rows in run_in_node(RUN, documents, folder):
        named = {}
        for body, accent, points in rows:
            kind = body.partition(".")[0]
            if kind == "m1":
                kind = f"m{accent}"
            elif f"leg{accent}/{kind}" in BODIES:
                kind = f"leg{accent}/{kind}"
            named[kind] = np.array(points).reshape(-1, 3)
        found.append(named)
    return found


def points_in_python(design: Design, pose: tuple[float, ...]) -> dict[str, Array]:
    """Return the same from `paminsa_viz.meshes`."""
    places = place_parts(inverse_kinematics(design.geometry, pose))
    matrices = {name: place.matrix for name, place in places.items()}
    with plain_shapes():
        parts = {name: make_body(design.geometry, name) for name in (*STANDING, *BODIES)}
        parts["payload"] = fixed_part("payload")
    if design.payload.mass > 0:
        size = payload_transform(design.geometry, design.payload.mass)
        matrices["payload"] = matrices["platform"] @ size
    found = {}
    for name, part in parts.items():
        if name == "payload" and name not in matrices:
            continue
        points = np.vstack([solid.mesh.vertices for solid in part.solids])
        matrix = matrices.get(name, np.eye(4))
        found[name] = points @ matrix[:3, :3].T + matrix[:3, 3]
    return found


@pytest.mark.slow
@pytest.mark.skipif(shutil.which("node") is None, reason="no node here")
@pytest.mark.parametrize("knee", KneeBranch)
def test_points_are_those_of_the_meshes(knee: KneeBranch, tmp_path: Path) -> None:
    rng = np.random.default_rng(7)
    first = APPENDIX_4.vary({"payload.mass": 4.0}).with_knee(knee)
    height = POSE[3] if knee is KneeBranch.LOWER else -POSE[3] - 0.02
    documents = [Document(design=first, pose=(*POSE[:3], height))]
    for size in (1.0, 1.0, 0.6):
        design = random_design(rng).with_knee(knee).vary({"geometry.body_scale": size})
        documents.append(Document(design=design, pose=tuple(random_poses(rng, design, 1)[0])))
    worst: dict[str, float] = {}
    compared = 0
    for index, found in enumerate(points_in_javascript(documents, tmp_path)):
        wanted = points_in_python(documents[index].design, documents[index].pose)
        assert found.keys() == wanted.keys()
        for name, points in wanted.items():
            # Arcs of the frame are exact for the design that the page is written with.
            if index and name in ("ground", "base"):
                continue
            if points.shape != found[name].shape:
                continue  # a piece without length is left out of the mesh
            compared += 1
            error = float(np.abs(points - found[name]).max())
            worst[name] = max(worst.get(name, 0.0), error)
    # The chamfer of the platform's plate is not quite linear in its radius.
    assert worst.pop("platform") < 2e-5
    assert {name: error for name, error in worst.items() if error > 1e-6} == {}
    assert compared > 0.9 * 4 * len(worst)


@pytest.mark.slow
@pytest.mark.skipif(shutil.which("node") is None, reason="no node here")
def test_a_small_robot_with_bodies_of_its_size_is_drawn_as_the_prototype(tmp_path: Path) -> None:
    times = 0.1
    whole = APPENDIX_4.vary({"payload.mass": 4.0})
    documents = [
        Document(design=design, pose=(size * POSE[0], size * POSE[1], POSE[2], size * POSE[3]))
        for design, size in ((whole, 1.0), (enlarged(whole, times), times))
    ]
    large, small = (points_in_javascript([document], tmp_path)[0] for document in documents)
    wanted = points_in_python(documents[1].design, documents[1].pose)
    assert wanted.keys() == small.keys() == large.keys()
    for name, points in small.items():
        np.testing.assert_allclose(points, wanted[name], atol=1e-6 * times, err_msg=name)
        np.testing.assert_allclose(points, times * large[name], atol=1e-6 * times, err_msg=name)


@pytest.mark.slow
@pytest.mark.skipif(shutil.which("node") is None, reason="no node here")
def test_bodies_that_are_tiny_beside_the_lengths_are_drawn(tmp_path: Path) -> None:
    design = APPENDIX_4.vary({"geometry.body_scale": 1e-4})
    (found,) = points_in_javascript([Document(design=design, pose=POSE)], tmp_path)
    for name, points in points_in_python(design, POSE).items():
        np.testing.assert_allclose(found[name], points, atol=1e-6, err_msg=name)
