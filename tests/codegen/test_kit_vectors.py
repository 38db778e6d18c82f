"""Test vectors of the controller kit: which states they are."""

from __future__ import annotations

import threading
from typing import Any

import numpy as np
import pytest

from paminsa_viz.codegen import controller_kit, kit
from paminsa_viz.codegen.kit import ROWS, WORST_CONDITION
from paminsa_viz.model import APPENDIX_4, Design, actuator_velocity, backend, inverse_kinematics
from paminsa_viz.model.design import PARAMETER
from paminsa_viz.model.reach import Limit, check_reach, workspace_height, workspace_radius
from paminsa_viz.model.singularity import measure_singularity
from tests.codegen.robots import DESIGNS, SIZES
from tests.support.documentation import missing


@pytest.mark.parametrize("name", DESIGNS)
def test_vectors_are_regular_poses_from_all_of_the_workspace_and_a_tenth_out_of_reach(
    name: str,
) -> None:
    design = DESIGNS[name]
    g = design.geometry
    text = controller_kit(design)["vectors.csv"].splitlines()
    names = text[0].split(",")
    rows = np.array([[float(cell) for cell in line.split(",")] for line in text[1:]])

    def column(*wanted: str) -> np.ndarray:
        return rows[:, [names.index(one) for one in wanted]]

    pose = column("pose_0", "pose_1", "pose_2", "pose_3")
    status, margin = column("status")[:, 0], column("margin")[:, 0]
    condition = column("singularity_1")[:, 0]
    inside = status == Limit.OK
    assert inside.tolist() == [True] * ROWS + [False] * (ROWS // 10)
    assert condition[inside].max() < WORST_CONDITION
    assert condition[inside].max() > 0.8 * WORST_CONDITION
    assert margin[inside].min() > 0.01 * g.base_radius
    assert margin[~inside].max() < 0
    # over the whole workspace, on the platform's side of the guides
    radius, height = workspace_radius(g), workspace_height(g)
    tried = pose[~inside]
    for column_, most in ((0, radius), (1, radius), (2, 1.0)):
        assert 0.8 * most < tried[:, column_].max() <= most
        assert 0.8 * most < -tried[:, column_].min() <= most
    away = -g.knee.sign * (pose[:, 3] + g.platform_joint_height)
    assert 0.1 * height <= away.min() < 0.25 * height
    assert 0.8 * height < away.max() <= height
    moving = [column(*(f"{kind}_{i}" for i in range(4))) for kind in ("velocity", "acceleration")]
    spread = np.concatenate(moving).std(axis=0)
    across = 0.3 * g.base_radius / APPENDIX_4.geometry.base_radius
    np.testing.assert_allclose(spread, [across, across, 1.0, across], rtol=0.07)
    said = [
        f"with {ROWS} states within reach and {ROWS // 10} out of it",
        "rates drawn with deviations of 0.3 m/s, 1 rad/s",
    ]
    assert missing("machine", [*said, f"condition numbers up to {WORST_CONDITION:g})"]) == []
    found = inverse_kinematics(g, pose[inside]).actuators
    given = column("actuators_0", "actuators_1", "actuators_2", "actuators_3")
    np.testing.assert_allclose(given[inside], found, rtol=1e-12)
    for wanted, digits in (("c", np.cos(pose[:, 2])), ("s", np.sin(pose[:, 2]))):
        np.testing.assert_allclose(column(wanted)[:, 0], digits, rtol=1e-15)


def test_vectors_are_those_of_numpy_where_kernels_are_loaded(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    used: Any = object()  # a kernel of it would be missing
    monkeypatch.setattr(backend._kernels, "module", used)
    monkeypatch.setattr(backend._kernels, "worth", 0)
    shared: list[bool] = []

    def draw(*rest: Any) -> Any:
        thread = threading.Thread(target=lambda: shared.append(backend.is_compiled()))
        thread.start()
        thread.join()
        return poses(*rest)

    poses = kit._poses
    monkeypatch.setattr(kit, "_poses", draw)
    kit.test_vectors(APPENDIX_4, 0)
    assert backend.is_compiled()
    assert shared == [True]  # other threads go on with the kernels


def test_vectors_of_a_robot_twice_as_large_are_twice_as_far_away() -> None:
    """To the last bit, as 2 is a power of 2; those out of reach are so by a length."""
    lengths = [
        path for path, item in PARAMETER.items() if path[:8] == "geometry" and item.unit == "m"
    ]
    large = APPENDIX_4.vary({path: 2.0 * APPENDIX_4.value(path) for path in lengths})
    one, other = kit._poses(APPENDIX_4, 0), kit._poses(large, 0)
    np.testing.assert_array_equal(other[:ROWS], one[:ROWS] * [2.0, 2.0, 1.0, 2.0])


def test_actuators_of_a_robot_of_any_size_turn_as_fast_in_the_vectors() -> None:
    """So that its rates count as much beside its weight, and rounding as little."""

    def turning(design: Design) -> np.ndarray:
        text = kit.test_vectors(design, 0).splitlines()
        rows = np.array([line.split(",") for line in text[1 : ROWS + 1]], float)
        named = dict(zip(text[0].split(","), rows.T, strict=True))
        pose, velocity = (
            np.column_stack([named[f"{kind}_{i}"] for i in range(4)])
            for kind in ("pose", "velocity")
        )
        return actuator_velocity(design.geometry, pose, velocity)[:, :3]

    wanted = turning(APPENDIX_4)
    for design in SIZES.values():
        np.testing.assert_allclose(turning(design), wanted, rtol=1e-6, atol=1e-9)


def test_poses_of_a_self_test_are_sought_among_forty_a_row(monkeypatch: pytest.MonkeyPatch) -> None:
    """So that robots that reach little of the box around them have some as well.

    Kept are the first: within reach by a hundredth of R_b, and out of it by 1 mm.
    """
    drawn: list[np.ndarray] = []

    def reach(geometry: Any, poses: Any) -> Any:
        drawn.append(poses)
        return check_reach(geometry, poses)

    monkeypatch.setattr(kit, "check_reach", reach)
    found = kit._poses(APPENDIX_4, 0)
    (tried,) = drawn
    assert len(tried) == 40 * ROWS
    margin = check_reach(APPENDIX_4.geometry, tried).margins.min(axis=(-1, -2))
    regular = measure_singularity(APPENDIX_4.geometry, tried).condition < WORST_CONDITION
    inside = tried[regular & (margin > 0.01 * APPENDIX_4.geometry.base_radius)]
    np.testing.assert_array_equal(found[:ROWS], inside[:ROWS])
    np.testing.assert_array_equal(found[ROWS:], tried[margin < -1e-3][: ROWS // 10])
