"""Proofs: what is proven holds at every pose, what is refuted has a pose that breaks it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from paminsa_viz.errors import InvalidInput
from paminsa_viz.model import APPENDIX_4, Design, check_reach, measure_singularity, static_torques
from paminsa_viz.model.reach import home_pose
from paminsa_viz.quantities.requirements import Requirement, Requirements, Workspace, WorkspaceShape
from paminsa_viz.synthesis.proof.certificate import prove
from paminsa_viz.synthesis.proof.evidence import Proof, Verdict, part_of
from paminsa_viz.synthesis.proof.families import Method
from paminsa_viz.synthesis.proof.regions import PoseRegion
from paminsa_viz.synthesis.volume.check import check_requirements
from paminsa_viz.synthesis.volume.margins import Columns, solve_columns
from tests.synthesis.certificate_robots import random_poses, robots
from tests.synthesis.robots import NEEDED, TURN, cylinder


def assert_holds(design: Design, requirements: Requirements, proof: Proof, n: int) -> None:
    poses = random_poses(proof.region, n, np.random.default_rng(1))
    torque = static_torques(design, poses)
    found = measure_singularity(design.geometry, poses)
    values = {
        "condition": found.condition,
        "determinant": found.determinant,
        "max_torque": np.abs(torque[:, :3]).max(axis=1),
        "tau_1": torque[:, 0],
        "f_4": torque[:, 3],
    }
    assert check_reach(design.geometry, poses).ok.all()
    home = measure_singularity(design.geometry, home_pose(design.geometry))
    assert (np.sign(found.determinant) == np.sign(home.determinant)).all()
    for item in proof.evidence:
        if item.requirement is not None and item.requirement in requirements.bounds:
            margin = item.requirement.margin(values[item.name])
            assert margin.min() >= item.margin - 1e-9 * abs(item.margin)


@pytest.mark.slow
def test_proven_workspace_of_appendix_4_meets_all_bounds_at_random_poses() -> None:
    proof = prove(APPENDIX_4, NEEDED, cylinder(0.3, 0.4))
    assert proof.verdict is Verdict.PROVEN
    assert proof.pose is None
    assert not len(proof.remaining)
    assert all(item.margin >= 0 for item in proof.evidence if item.requirement)
    assert_holds(APPENDIX_4, NEEDED, proof, 100_000)


@pytest.mark.parametrize(
    ("bound", "workspace"),
    [
        (Requirement("condition", high=10.0), cylinder(0.38, 0.4)),
        (Requirement("tau_2", low=-2.0), cylinder(0.3, 0.4)),
        (Requirement("f_4", high=240.0), cylinder(0.3, 0.4)),
        (Requirement("determinant", low=0.0), cylinder(0.1, 0.1)),
    ],
)
def test_refuted_workspace_has_a_pose_that_breaks_the_bound(
    bound: Requirement, workspace: Workspace
) -> None:
    proof = prove(APPENDIX_4, Requirements((bound,), (-TURN, TURN)), workspace)
    assert proof.verdict is Verdict.REFUTED
    assert proof.pose is not None
    pose = np.array(proof.pose)
    torque, found = static_torques(APPENDIX_4, pose), measure_singularity(APPENDIX_4.geometry, pose)
    value = {
        "condition": found.condition,
        "determinant": found.determinant,
        "tau_2": torque[1],
        "f_4": torque[3],
    }[bound.quantity]
    assert bound.margin(value) < 0
    assert np.hypot(pose[0], pose[1]) <= 0.5 * workspace.size[0] * (1 + 1e-12)
    assert abs(pose[3] + 0.6) <= 0.5 * workspace.size[2] * (1 + 1e-12)
    assert abs(pose[2]) <= TURN


@pytest.mark.parametrize(
    ("workspace", "name"), [(cylinder(0.3, 0.9), "reach"), (cylinder(0.52, 0.1), "singularity")]
)
def test_refuted_reach_has_a_pose_that_cannot_be_taken(workspace: Workspace, name: str) -> None:
    proof = prove(APPENDIX_4, Requirements((), (-TURN, TURN)), workspace)
    assert proof.verdict is Verdict.REFUTED
    assert [item.name for item in proof.evidence if item.verdict is Verdict.REFUTED] == [name]
    found = measure_singularity(APPENDIX_4.geometry, np.array(proof.pose))
    reach = check_reach(APPENDIX_4.geometry, np.array(proof.pose))
    assert not reach.ok or found.position_distance < 0


def test_time_that_is_over_leaves_boxes_undecided() -> None:
    proof = prove(APPENDIX_4, NEEDED, cylinder(0.3, 0.4), time_limit=0.0)
    assert proof.verdict is Verdict.UNDECIDED
    assert len(proof.remaining)


def test_a_proof_can_be_stopped() -> None:
    parts: list[float] = []

    def stop(part: float) -> bool:
        parts.append(part)
        return len(parts) > 3

    proof = prove(APPENDIX_4, NEEDED, cylinder(0.3, 0.4), progress=stop)
    assert proof.verdict is Verdict.UNDECIDED
    assert parts == sorted(parts)
    assert len(parts) == 4


@pytest.mark.slow
def test_bounds_hold_over_their_own_headings_and_heights() -> None:
    # on r = 186 mm kappa is 10.4 at theta = 0, and at most 9.7 from 0.3 to 0.4 rad
    own = Requirement("condition", high=10.0, theta=(0.3, 0.4))
    assert prove(APPENDIX_4, Requirements((own,)), cylinder(0.372, 0.1)).verdict is Verdict.PROVEN
    everywhere = Requirement("condition", high=10.0)
    proof = prove(APPENDIX_4, Requirements((everywhere,)), cylinder(0.372, 0.1))
    assert proof.verdict is Verdict.REFUTED
    # F_4 comes down to 230 N at the top, and to 237 N at z = -500 mm
    for z, verdict in (((-0.8, -0.5), Verdict.PROVEN), (None, Verdict.REFUTED)):
        low = Requirement("f_4", low=235.0, z=z)
        assert prove(APPENDIX_4, Requirements((low,)), cylinder(0.2, 0.4)).verdict is verdict
    never = Requirement("f_4", high=1.0, z=(-3.0, -2.0))
    assert prove(APPENDIX_4, Requirements((never,)), cylinder(0.2, 0.4)).verdict is Verdict.PROVEN


@pytest.mark.slow
def test_what_cannot_be_proven_is_named_and_sampled() -> None:
    sampled = Requirement("transmission", low=0.1)
    impossible = Requirement("transmission", low=0.99)
    proof = prove(APPENDIX_4, replace(NEEDED, bounds=(*NEEDED.bounds, sampled)), cylinder(0.2, 0.2))
    assert proof.verdict is Verdict.PROVEN
    assert proof.sampled == (sampled,)
    assert proof.evidence[-1].verdict is Verdict.SAMPLED
    proof = prove(APPENDIX_4, Requirements((impossible,)), cylinder(0.2, 0.2))
    assert proof.verdict is Verdict.REFUTED
    assert proof.evidence[-1].method is Method.SAMPLED


ASIDE = (0.02, -0.01, home_pose(APPENDIX_4.geometry)[3])
"""A center that no leg is symmetric to."""


@pytest.mark.slow
@pytest.mark.parametrize("shape", WorkspaceShape)
@pytest.mark.parametrize(
    ("quantity", "fine"),
    [
        ("speed", False), ("speed", True), ("turn_speed", False), ("horizontal_force", True),
        ("moment", False),
    ],
)  # fmt: skip
def test_what_a_check_refutes_is_refuted(quantity: str, shape: WorkspaceShape, fine: bool) -> None:
    """A bound that the worst sample of a check just breaks; on a cylinder, that is on its wall."""
    space = Workspace(shape, (0.16, 0.16, 0.06), ASIDE)
    needed = Requirements((Requirement(quantity, low=0.0),), (-0.35, 0.5), space)
    worst = check_requirements(APPENDIX_4, needed, fine=fine).items[-1].value
    broken = replace(needed, bounds=(Requirement(quantity, low=worst * (1 + 1e-9)),))
    assert not check_requirements(APPENDIX_4, broken, fine=fine).holds
    proof = prove(APPENDIX_4, broken)
    assert proof.verdict is proof.evidence[-1].verdict is Verdict.REFUTED
    assert proof.evidence[-1].bound <= worst


@pytest.mark.slow
def test_no_random_pose_is_far_beyond_the_worst_sample() -> None:
    space = Workspace(WorkspaceShape.CYLINDER, (0.16, 0.16, 0.06), ASIDE)
    needed = Requirements((Requirement("speed", low=0.1),), (-0.35, 0.5), space)
    proof = prove(APPENDIX_4, needed)
    poses = random_poses(proof.region, 4000, np.random.default_rng(0))
    headings = np.linspace(*needed.theta, 9)
    field = solve_columns(
        APPENDIX_4.geometry, Columns.at(poses[:, :2], headings, np.array([ASIDE[2]]))
    )
    least = np.nanmin(needed.bounds[0].entry.over(field, APPENDIX_4))
    assert proof.evidence[-1].bound <= least * (1 + 1e-4)


def test_a_margin_of_reach_is_proven_in_closed_form() -> None:
    for low, verdict in ((0.05, Verdict.PROVEN), (0.06, Verdict.REFUTED)):
        needed = Requirements((Requirement("reach_margin", low=low),), (-TURN, TURN))
        proof = prove(APPENDIX_4, needed, cylinder(0.3, 0.4))
        assert proof.verdict is verdict
        assert proof.boxes == 0


def test_the_path_from_home_is_free() -> None:
    proof = prove(APPENDIX_4, Requirements((), (0.5, 0.6)), cylinder(0.1, 0.1, -0.3))
    assert proof.verdict is Verdict.PROVEN
    np.testing.assert_array_equal(proof.path[0], home_pose(APPENDIX_4.geometry))
    np.testing.assert_allclose(proof.path[-1], [0, 0, 0.5, -0.3])
    share = np.linspace(0, 1, 50)[:, None]
    for first, last in zip(proof.path, proof.path[1:], strict=False):
        poses = first + share * (last - first)
        assert check_reach(APPENDIX_4.geometry, poses).ok.all()
        assert (measure_singularity(APPENDIX_4.geometry, poses).position_distance > 0).all()


def test_poses_beyond_the_singular_rotation_are_refused() -> None:
    # every pose at 100 degrees can be taken, but not be reached from home
    proof = prove(APPENDIX_4, Requirements((), (1.7, 1.75)), cylinder(0.02, 0.02))
    assert proof.verdict is Verdict.REFUTED


def test_headings_of_a_requirement_have_to_be_reached_too() -> None:
    # 1.4 rad is beyond the singular rotation
    beyond = Requirement("f_4", high=450.0, theta=(1.4, 1.5))
    proof = prove(APPENDIX_4, Requirements((beyond,)), cylinder(0.1, 0.1))
    assert proof.verdict is Verdict.REFUTED
    assert proof.pose is not None
    assert 1.4 <= proof.pose[2] <= 1.5


def test_a_region_that_no_path_from_home_reaches_is_not_proven() -> None:
    # Bars of 250 and 800 mm fold before the platform comes up through the guides.
    lengths = {"geometry.crank_length": 0.25, "geometry.coupler_length": 0.8}
    design = APPENDIX_4.vary(lengths)
    proof = prove(design, Requirements(()), cylinder(0.04, 0.04, 0.55))
    assert {item.name: item.verdict for item in proof.evidence} == {
        "reach": Verdict.PROVEN,
        "singularity": Verdict.PROVEN,
        "home": Verdict.UNDECIDED,
    }
    assert proof.verdict is Verdict.UNDECIDED
    assert not len(proof.path)
    assert prove(design, Requirements(()), cylinder(0.04, 0.04, -0.6)).verdict is Verdict.PROVEN


@pytest.mark.slow
@settings(max_examples=15)
@given(design=robots(), high=st.floats(1.5, 20.0), seed=st.integers(0, 99))
def test_verdicts_agree_with_poses(design: Design, high: float, seed: int) -> None:
    rng = np.random.default_rng(seed)
    g = design.geometry
    size = abs(g.base_radius - g.platform_radius) * rng.uniform(0.2, 1.2)
    x, y, _, z = home_pose(g)
    turn = rng.uniform(0.0, 0.5)
    shape = WorkspaceShape.BOX if seed % 2 else WorkspaceShape.CYLINDER
    workspace = Workspace(shape, (size, size, size), (x, y, z))
    bounds = (Requirement("condition", high=high), Requirement("tau_1", low=-50.0, high=50.0))
    needed = Requirements(bounds, (-turn, turn))
    proof = prove(design, needed, workspace, time_limit=0.1)
    if proof.verdict is Verdict.PROVEN:
        assert_holds(design, needed, proof, 2000)
    elif proof.verdict is Verdict.REFUTED:
        assert proof.pose is not None
        pose = np.array(proof.pose)
        found = measure_singularity(g, pose)
        fine = check_reach(g, pose).ok and found.condition <= high and found.determinant != 0
        fine &= abs(static_torques(design, pose)[0]) <= 50
        regular = found.position_distance > 0 and found.rotation_distance > 0
        assert not (fine and regular)


def test_a_workspace_with_a_center_is_needed() -> None:
    with pytest.raises(InvalidInput, match="workspace is needed"):
        prove(APPENDIX_4, NEEDED)
    with pytest.raises(InvalidInput, match="three numbers"):
        prove(APPENDIX_4, NEEDED, Workspace(WorkspaceShape.BOX, (0.1, 0.1, 0.1)))


@given(st.floats(-0.9, -0.3), st.floats(0.02, 0.3), st.floats(-1.2, 0.0), st.floats(0.0, 0.6))
def test_a_requirement_is_about_the_heights_of_its_range_in_the_region(
    middle: float, half: float, low: float, width: float
) -> None:
    bound = Requirement("condition", None, 10.0, z=(low, low + width))
    requirements = Requirements((bound,), (-TURN, TURN))
    center = (0.01, -0.02, middle)
    region = PoseRegion(WorkspaceShape.CYLINDER, center, (0.1, 0.1, half), (-TURN, TURN))
    part = part_of(requirements, bound, region)
    ends = max(low, middle - half), min(low + width, middle + half)
    if part is None:
        assert ends[0] > ends[1]
        return
    assert (part.low[2], part.high[2]) == pytest.approx(ends, abs=1e-12)
    assert (part.low[:2], part.high[:2]) == (region.low[:2], region.high[:2])
