"""Robots that can be built: drawn bodies that do not overlap, bars that grow, what answers say."""

from __future__ import annotations

import json
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import nnls
from scipy.spatial import ConvexHull

from paminsa_viz.blocks.data import plain
from paminsa_viz.blocks.kinds import Note, Table
from paminsa_viz.blocks.synthesis import (
    OVERLAP_ALLOWED,
    buildability_data,
    buildability_table,
    synthesis_blocks,
)
from paminsa_viz.clearance import clearance, pair_clearance, shapes_of
from paminsa_viz.dimensions import needs
from paminsa_viz.dimensions.layers import SLIDER_HALF
from paminsa_viz.elastostatics import platform_stiffness
from paminsa_viz.model import (
    APPENDIX_4,
    BarLaw,
    Geometry,
    KneeBranch,
    check_reach,
    inverse_kinematics,
    resized,
)
from paminsa_viz.model.design import Design
from paminsa_viz.progress import Canceled, Progress, keep_on
from paminsa_viz.quantities.requirements import Requirement, Workspace, WorkspaceShape
from paminsa_viz.synthesis import (
    Buildability,
    Effort,
    Evaluator,
    Regime,
    SynthesisCase,
    SynthesisResult,
    buildability,
    synthesize,
)
from paminsa_viz.synthesis.search import result as result_file
from paminsa_viz.synthesis.search.buildability import best_height
from paminsa_viz.synthesis.search.evaluation import REFUSED
from paminsa_viz.synthesis.search.extremes import Extent, Least, Valued
from paminsa_viz.synthesis.search.kernels import plate_distance
from paminsa_viz.synthesis.search.region import SPARSE, Density
from paminsa_viz.synthesis.search.trial import Poses, TrialRobot
from tests.support.samples import enlarged
from tests.synthesis.search_cases import CELL, CYLINDER, TURN
from tests.synthesis.test_trials import GOOD, random_numbers

BUILDABLE = replace(CYLINDER, allow_overlap=False, effort=Effort(25, 5), regimes=(Regime.SMALLER,))

lengths = st.fixed_dictionaries(
    {
        "magnification": st.floats(1.6, 5.0),
        "base_radius": st.floats(0.15, 0.6),
        "platform_radius": st.floats(0.06, 0.2),
        "crank_length": st.floats(0.2, 0.8),
        "coupler_length": st.floats(0.2, 0.9),
        "shaft_length": st.floats(0.05, 0.8),
        "knee": st.sampled_from(KneeBranch),
        "body_scale": st.sampled_from((1.0, 0.4)),
    }
)


def reachable(geometry: Geometry, count: int) -> np.ndarray:
    """Random poses that can be taken, on the platform's side of the guides."""
    rng = np.random.default_rng(0)
    bars = geometry.crank_length + geometry.coupler_length
    z = -geometry.knee.sign * rng.uniform(0.02, 1.0, count) * bars
    xy, theta = rng.uniform(-0.2, 0.2, (count, 2)), rng.uniform(-0.6, 0.6, count)
    pose = np.column_stack([xy, theta, z - geometry.platform_joint_height])
    return pose[inverse_kinematics(geometry, pose).reach.ok]


@pytest.mark.slow
@settings(max_examples=25, deadline=None)
@given(lengths=lengths)
def test_cheap_bounds_exclude_no_robot_that_the_bodies_accept(lengths: dict) -> None:
    try:
        geometry = replace(APPENDIX_4.geometry, guide_link_length=1.0, **lengths)
    except ValueError:
        return
    design = replace(APPENDIX_4, geometry=geometry)
    pose = reachable(geometry, 60)
    found = inverse_kinematics(geometry, pose)
    k = geometry.magnification
    rho = np.linalg.norm((found.points[5] - found.points[3])[..., :2], axis=-1)
    zeta = np.abs(found.points[5][..., 0, 2])
    apart = np.linalg.norm(found.points[8] - found.points[5], axis=-1)
    missing = needs.missing_room(
        [geometry] * len(pose), rho.min(axis=1) / (k - 1), np.stack([zeta, zeta], axis=1),
        np.stack([apart.min(axis=1), apart.max(axis=1)], axis=1), 0.001,
    )  # fmt: skip
    broken = (missing > 1e-9).any(axis=1)
    assert (clearance(design, pose[broken]).least < 0.001).all()
    # ... and each by its own two bodies
    shapes = shapes_of(design)
    for column, (one, other) in enumerate(
        (("slider", "joint 1"), ("joint 3", "joint 1"), ("arm B1", "joint 1"), ("B4", "B7"))
    ):
        which = np.flatnonzero(missing[:, column] > 1e-9)[:2]
        if len(which):
            pairs = [{f"{one} of leg {n}", f"{other} of leg {n}"} for n in (1, 2, 3)]
            columns = [i for i, pair in enumerate(shapes.names) if set(pair) in pairs]
            own = pair_clearance(design, pose[which])[:, columns].min(axis=1)
            assert (own <= np.maximum(0.001 - missing[which, column], 0.0) + 1e-9).all()


@pytest.mark.slow
@settings(max_examples=12, deadline=None)
@given(lengths=lengths)
def test_plate_kernel_is_no_more_than_the_distance_of_the_bodies(lengths: dict) -> None:
    try:
        geometry = replace(APPENDIX_4.geometry, guide_link_length=1.0, **lengths)
    except ValueError:
        return
    design = replace(APPENDIX_4, geometry=geometry)
    names = shapes_of(design).names
    platform = [i for i, p in enumerate(names) if "the platform" in p and "B4" in p[0] + p[1]]
    assert len(platform) == 3
    for pose in reachable(geometry, 6):
        space = Workspace(WorkspaceShape.BOX, (1e-9, 1e-9, 1e-9), tuple(pose[[0, 1, 3]]))
        case = replace(
            CYLINDER, ranges=CYLINDER.ranges[:5],
            requirements=replace(CYLINDER.requirements, workspace=space),
        )  # fmt: skip
        masses = np.zeros(28)
        trial = TrialRobot(Poses(case), np.zeros(0), geometry, space, masses, np.zeros(18))
        cheap = trial.plate_distance((pose[2], pose[2]), 0.001)
        if cheap < 0.001:
            exact = pair_clearance(design, pose)[platform].min()
            assert exact <= max(cheap, 0.0) + 1e-6


@given(st.integers(0, 10**6))
@settings(max_examples=30)
def test_distance_of_a_plate_is_that_of_the_nearest_mixture_of_its_corners(seed: int) -> None:
    """Outside; inside, a ball of that radius and no larger one is within the plate."""
    rng = np.random.default_rng(seed)
    angles = np.sort(rng.uniform(0.0, 2.0 * np.pi, 5))
    corners = np.column_stack([np.cos(angles), np.sin(angles)])  # counterclockwise and convex
    low, top = np.sort(rng.uniform(-1.0, 1.0, 2))
    solid = np.array([[*corner, z] for corner in corners for z in (low, top)])
    for point in rng.uniform(-1.5, 1.5, (5, 3)):
        found = plate_distance(corners, low, top, *point)
        # weights of corners that sum to one, by a row that outweighs the others
        rows = np.vstack([solid.T, np.full(len(solid), 1e4)])
        weights, _ = nnls(rows, np.append(point, 1e4))
        nearest = np.linalg.norm(solid.T @ weights - point)
        assert max(found, 0.0) == pytest.approx(nearest, abs=1e-6)
        if found < 0.0:
            hull = ConvexHull(solid).equations
            assert found == pytest.approx((hull[:, :3] @ point + hull[:, 3]).max(), abs=1e-9)


@cache
def short() -> SynthesisResult:
    return synthesize(BUILDABLE)


def both(result: SynthesisResult) -> tuple[Buildability, Buildability]:
    """The robot and the reference."""
    found = result.buildability
    assert found is not None
    return found


@pytest.mark.slow
def test_answer_is_clear_at_random_poses_of_its_workspace() -> None:
    result = short()
    assert result.feasible
    extent = Extent(result.workspace, result.case.requirements.theta)
    assert clearance(result.design, extent.random(1000, seed=7)).least.min() > 0
    robot, reference = both(result)
    assert robot.clear
    assert robot.overlapping == 0
    assert 0.001 <= robot.clearance < 0.02
    assert result.objective > 0.62  # 0.482 with overlap
    assert 0.4 < reference.guide / 0.3635 <= 1
    # the smaller robots that a search finds with overlap cannot be built
    trial = Evaluator(CYLINDER, Regime.SMALLER).evaluate(np.array([GOOD["cylinder"][1]]))[0].trial
    assert trial is not None
    assert trial.footprint < 0.8 * result.objective
    worse = buildability(trial.design, trial.workspace, (-TURN, TURN))
    assert not worse.clear
    assert worse.overlapping > 0.5
    assert worse.clearance < -0.02
    assert {"slider of leg", "joint 1 of leg", "B4 of leg", "the platform"} & {
        name.rstrip("123 ") for name in worse.bodies
    }


@pytest.mark.slow
def test_answer_says_on_all_ways_whether_it_can_be_built() -> None:
    result = short()
    assert result.case.title == "synthesis" == result.design.name
    blocks = synthesis_blocks(result)
    assert OVERLAP_ALLOWED not in [b.text for b in blocks if isinstance(b, Note)]
    (table,) = [b for b in blocks if isinstance(b, Table) and b.head[-1] == "Before"]
    assert table == buildability_table(*both(result))
    assert not any(row.kind == "marked" for row in table.rows)
    data = json.loads(json.dumps(plain(buildability_data(result))))["robot"]
    assert data["clearance_m"] == both(result)[0].clearance
    marked = replace(result, case=replace(CYLINDER, name="c"))
    assert OVERLAP_ALLOWED in [b.text for b in synthesis_blocks(marked) if isinstance(b, Note)]
    assert marked.case.title == "c, overlap allowed"


def too_short(times: float) -> Buildability:
    """A robot of some size with too short a guide, and joint 8 nearer to its axis than the slider
    is long."""
    place = (times * 0.3, times * 0.3, times * 0.1), (0.0, 0.0, times * -0.55)
    short_guide = enlarged(APPENDIX_4.vary({"geometry.guide_link_length": 0.22}), times)
    return buildability(short_guide, Workspace(WorkspaceShape.CYLINDER, *place), (-0.1, 0.1))


@pytest.mark.slow
def test_faults_of_a_robot_are_named() -> None:
    found = too_short(1.0)
    assert found.guide < found.needed_guide
    assert found.needed_shaft < found.shaft
    assert not found.clear
    rows = {row.cells[0]: row.kind for row in buildability_table(found, found).rows}
    assert rows["Guide B10"] == "marked"
    assert rows["Shaft B2"] == "plain"


@pytest.mark.slow
def test_a_robot_enlarged_with_its_bodies_can_be_built_as_well() -> None:
    whole, small = too_short(1.0), too_short(0.1)
    for name in ("clearance", "guide", "needed_guide", "shaft", "needed_shaft"):
        assert getattr(small, name) == pytest.approx(0.1 * getattr(whole, name), abs=1e-9), name
    assert small.overlapping == whole.overlapping


def test_least_values_are_looked_for_from_six_four_and_one_of_the_samples(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Of distances, stiffness and the frequency, which takes longest and has sparse samples."""
    place, looked = "paminsa_viz.synthesis.search.buildability", []

    def least(values: Any, extent: Any, density: Any, *, starts: int, progress: Any) -> Least:
        of_pairs = values(extent.samples(Density(4, 2, 1, 1))).kind is not None
        looked.append((starts, density, of_pairs))
        return Least(-4e-10, np.array([0.0, 0.0, 0.0, -0.55]))

    monkeypatch.setattr(f"{place}.least_over", least)
    space = Workspace(WorkspaceShape.CYLINDER, (0.123, 0.123, 0.1), (0.02, 0.0, -0.55))
    found = buildability(APPENDIX_4, space, (-0.1, 0.1))
    close = SPARSE.finer(2)
    assert looked == [(6, close, True), (4, close, False), (1, SPARSE.finer(1), False)]
    # rounding is no overlap
    assert str(found.clearance) == str(found.stiffness) == str(found.frequency) == "0.0"
    assert found.center == (0.02, 0.0, -0.55)
    # what else is said of it: the farthest slider and joint 5, and all that moves
    pose = Extent(space, (-0.1, 0.1)).samples(SPARSE.finer(4))
    points = inverse_kinematics(APPENDIX_4.geometry, pose).points
    slider = np.linalg.norm((points[8] - points[3])[..., :2], axis=-1).max()
    assert found.needed_guide == pytest.approx(slider + SLIDER_HALF, abs=1e-4)
    deep = np.abs(points[5][..., 2]).max()
    k = np.array([APPENDIX_4.geometry.magnification])
    assert found.needed_shaft == pytest.approx(needs.needed_shaft(APPENDIX_4, np.array([deep]), k))
    links, joints = vars(APPENDIX_4.links).values(), vars(APPENDIX_4.joints).values()
    moving = 3 * (sum(links) + sum(joints)) + APPENDIX_4.platform.mass
    assert found.moving_mass == pytest.approx(moving)


def test_looking_for_least_values_is_told_of_and_can_be_ended(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Before the samples and each round of all three; a kept answer has nothing to tell."""
    place = "paminsa_viz.synthesis.search.buildability"
    told: list[float] = []
    monkeypatch.setattr(f"{place}.RANDOM", 1)
    names = ("clearance", "stiffness_horizontal", "frequency_1")
    slope = dict.fromkeys(names, lambda design, pose: Valued(pose[:, 0] + 1.0))
    monkeypatch.setattr(f"{place}.OVER_POSES", slope)
    space = Workspace(WorkspaceShape.CYLINDER, (0.124, 0.124, 0.1), (0.02, 0.0, -0.55))

    def found(ended: int = 0) -> Buildability:
        told.clear()

        def tell(done: float, /, **_: Any) -> bool:
            told.append(done)
            return len(told) == ended

        return buildability(APPENDIX_4, space, (-0.1, 0.1), progress=tell)

    for ended in (1, 30):
        with pytest.raises(Canceled):
            found(ended)
        assert len(told) == ended
    assert found().stiffness == pytest.approx(1.02 - 0.062)
    assert told == pytest.approx(np.arange(75) / 75)
    found()
    assert not told


def test_what_is_out_of_reach_counts_for_nothing() -> None:
    far = Workspace(WorkspaceShape.BOX, (0.1, 0.1, 0.1), (0.0, 0.0, -3.0))
    none = buildability(APPENDIX_4, far, (-0.1, 0.1))
    assert none.within_reach == 0.0
    assert none.bodies == ("", "")
    values = none.clearance, none.overlapping, none.stiffness, none.frequency
    assert np.isnan(values).all()
    assert not none.clear


def test_a_robot_is_clear_with_guides_and_shafts_that_are_just_long_enough() -> None:
    fine = Buildability(
        (0.0, 0.0, -0.5), 1.0, 0.001, ("", ""), np.zeros(4), 0.0, 1e4, 20.0, 0.3, 0.3, 0.4, 0.4, 5.0
    )  # fmt: skip
    assert fine.clear
    assert replace(fine, needed_guide=0.2, needed_shaft=0.3).clear
    for change in (
        {"clearance": 0.0}, {"clearance": -0.001}, {"overlapping": 0.001},
        {"overlapping": float("nan")}, {"needed_guide": 0.3001}, {"needed_shaft": 0.4001},
    ):  # fmt: skip
        assert not replace(fine, **change).clear  # type: ignore[arg-type]


@pytest.mark.parametrize("height", [None, -0.6])
def test_a_reference_is_looked_at_in_the_workspace_of_the_answer(
    height: float | None, monkeypatch: pytest.MonkeyPatch
) -> None:
    """At its own best height, where that is free; where there is no robot, none is."""
    asked: list[tuple[Design, Workspace]] = []

    def note(design: Design, space: Workspace, theta: Any, *, progress: Progress) -> str:
        assert theta == (-TURN, TURN)
        asked.append((design, space))
        keep_on(progress, 0.5)
        return "found"

    monkeypatch.setattr(result_file, "buildability", note)
    space = replace(CYLINDER.workspace, center=(0.0, 0.0, height))
    case = replace(
        CYLINDER, requirements=replace(CYLINDER.requirements, workspace=space),
        ranges=CYLINDER.ranges[:5],
    )  # fmt: skip
    placed, longer = (
        replace(space, center=(0.0, 0.0, -0.75)),
        APPENDIX_4.with_knee(KneeBranch.UPPER),
    )
    found = SynthesisResult(case, longer, placed, None, True, 0.5, (), (), {}, (), False, 7)
    assert found.buildability == ("found", "found")
    best = best_height(APPENDIX_4, placed, (-TURN, TURN))
    assert best != placed
    assert asked == [(longer, placed), (APPENDIX_4, best if height is None else placed)]
    assert replace(found, poses=0).buildability is None
    told: list[float] = []
    again = replace(found)
    again.check_buildability(lambda done, /, **_: told.append(done))
    assert told == [0.25, 0.75]
    count = len(asked)
    assert again.buildability == ("found", "found")  # kept with the answer
    assert len(asked) == count


@pytest.mark.parametrize("knee", KneeBranch)
@pytest.mark.parametrize(
    ("crank", "coupler", "base", "high"),
    [(0.42, 0.68, 0.55, 0.3), (0.5, 0.5, 0.55, 0.3), (0.2, 1.0, 0.3, 0.1)],
)
def test_a_reference_is_placed_where_its_reach_has_most_room(
    crank: float, coupler: float, base: float, high: float, knee: KneeBranch
) -> None:
    """All of its workspace on the platform's side of the guides; bars of one length at them."""
    geometry = replace(
        APPENDIX_4.geometry, crank_length=crank, coupler_length=coupler, guide_link_length=2.0,
        knee=knee, base_radius=base,
    )  # fmt: skip
    space = Workspace(WorkspaceShape.CYLINDER, (0.2, 0.2, high), (0.03, -0.02, None))
    found = best_height(replace(APPENDIX_4, geometry=geometry), space, (-0.3, 0.2))
    assert replace(found, center=space.center) == space
    side = -knee.sign
    middle = (found.center[2] or 0.0) + geometry.platform_joint_height

    def margin(height: float) -> float:
        placed = replace(space, center=(0.03, -0.02, height - geometry.platform_joint_height))
        pose = Extent(placed, (-0.3, 0.2)).samples(SPARSE.finer(2))
        return float(check_reach(geometry, pose).margins.min())

    others = side * np.linspace(0.5 * high, crank + coupler, 60)
    best = max(map(margin, others.tolist()))
    assert best > 0.02
    assert margin(middle) > best - 0.01
    assert side * middle >= 0.5 * high - 1e-12
    if crank == coupler:
        assert side * middle == pytest.approx(0.5 * high)


@pytest.mark.slow
@pytest.mark.parametrize("case", [CYLINDER, CELL])
def test_costs_that_do_not_matter_are_not_worked_out(case: SynthesisCase) -> None:
    numbers = random_numbers(case, 400)
    near = np.array(GOOD["cell" if case is CELL else "cylinder"][1])
    numbers[:200] = near * (1 + 0.001 * np.random.default_rng(1).normal(size=(200, 6)))
    evaluator = Evaluator(case, Regime.SMALLER)
    whole = np.array(evaluator.costs(list(numbers)))
    assert (whole < REFUSED).sum() > 5
    for most in (np.median(whole[whole < REFUSED]), 2 * REFUSED):
        found = np.array(evaluator.costs(list(numbers), [most] * len(numbers)))
        assert (found[whole <= most] == whole[whole <= most]).all()
        assert (found[whole > most] > most).all()


def similar(design: Design, ratio: float, law: BarLaw) -> Design:
    """The design with all its lengths longer by one ratio."""
    names = (
        "base_radius", "platform_radius", "arm_length", "shaft_length", "crank_length",
        "coupler_length", "platform_joint_height", "guide_link_length",
    )  # fmt: skip
    longer = {f"geometry.{n}": ratio * getattr(design.geometry, n) for n in names}
    return resized(design, longer, law)


@pytest.mark.parametrize("ratio", [0.7, 2.0])
def test_stiffness_of_similar_robots_grows_with_the_length_where_tubes_do(ratio: float) -> None:
    # of similar bodies of one material, forces for a given strain grow with the square of lengths,
    # so that force over displacement grows with the length, moment over rotation with its cube
    stiff = {"elastic.drive_rotary": 1e18, "elastic.drive_linear": 1e18}
    design = APPENDIX_4.vary(stiff)
    pose = np.array([0.05, -0.03, 0.2, -0.5])
    scaled = pose * [ratio, ratio, 1.0, ratio]
    before = platform_stiffness(design, pose).matrix
    power = np.array([[1, 2], [2, 3]]).repeat(3, axis=0).repeat(3, axis=1)
    grown = similar(design, ratio, BarLaw(grow=True))
    after = platform_stiffness(grown, scaled).matrix
    assert after == pytest.approx(before * ratio**power, rel=1e-6, abs=1e-6 * np.abs(after).max())
    # with the same cross section it falls, as bending does with the cube of the length
    kept = platform_stiffness(similar(design, ratio, BarLaw()), scaled)
    soft = kept.horizontal / platform_stiffness(design, pose).horizontal
    assert (soft < ratio) == (ratio > 1)
    assert soft == pytest.approx(ratio**-3, rel=0.5)


def test_masses_of_tubes_follow_from_section_and_length() -> None:
    ratio = 1.5
    changes = {"geometry.crank_length": ratio * 0.42, "geometry.arm_length": ratio * 0.308}
    tube = resized(APPENDIX_4, changes, BarLaw(tubes=True))
    e = APPENDIX_4.elastic
    area = np.pi / 4 * (e.b8_outer**2 - e.b8_inner**2)
    mass = 2700.0 * area * ratio * 0.42
    assert tube.links.b8 == pytest.approx(mass)
    squares = e.b8_outer**2 + e.b8_inner**2
    assert tube.inertias.b8_axial == pytest.approx(mass * squares / 8)
    across = mass * ((ratio * 0.42) ** 2 / 12 + squares / 16)
    assert tube.inertias.b8_transverse == pytest.approx(across)
    grown = resized(APPENDIX_4, changes, BarLaw(grow=True, tubes=True))
    assert grown.links.b8 == pytest.approx(ratio**2 * mass)
    assert grown.links.b1 == pytest.approx(ratio**2 * tube.links.b1)
    assert grown.elastic.b1_outer == pytest.approx(ratio * e.b1_outer)
    assert grown.elastic.b4_outer == e.b4_outer
    in_proportion = resized(APPENDIX_4, changes, BarLaw(grow=True))
    assert in_proportion.links.b1 == pytest.approx(ratio**3 * APPENDIX_4.links.b1)
    assert in_proportion.inertias.b8_transverse == pytest.approx(
        ratio**5 * APPENDIX_4.inertias.b8_transverse
    )
    given = APPENDIX_4.vary({"elastic.b8_area": 1e-4, "elastic.b8_torsion": 1e-8})
    section = resized(given, changes, BarLaw(grow=True)).elastic.section("b8")
    assert section.area == pytest.approx(ratio**2 * 1e-4)
    assert section.torsion == pytest.approx(ratio**4 * 1e-8)


@pytest.mark.slow
def test_stiffness_can_be_required_and_takes_tubes_that_grow() -> None:
    low = Requirement("stiffness_horizontal", low=2e4)
    required = replace(CYLINDER.requirements, bounds=(*CYLINDER.requirements.bounds, low))
    case = replace(
        CYLINDER, requirements=required, effort=Effort(10, 4), regimes=(Regime.SMALLER,), seed=1,
        bars=BarLaw(grow=True),
    )  # fmt: skip
    result = synthesize(case, relax=False)
    assert result.feasible
    pose = Extent(result.workspace, (-TURN, TURN)).random(300, seed=3)
    assert platform_stiffness(result.design, pose).horizontal.min() > 2e4 * 0.97
