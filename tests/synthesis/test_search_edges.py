"""Searches where something is exactly at its limit, or of the kind that is seldom asked for."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from paminsa_viz.dimensions.needs import missing_room, needed_guide, needed_shaft
from paminsa_viz.model import APPENDIX_4, Counterweight, KneeBranch, LoadCase, inverse_kinematics
from paminsa_viz.model.parameters import LARGEST
from paminsa_viz.progress import Canceled
from paminsa_viz.quantities.requirements import Requirement, Workspace, WorkspaceShape
from paminsa_viz.studies.executors import here
from paminsa_viz.synthesis import Effort, Evaluator, Guide, ObjectiveLimit, Regime, SearchRange
from paminsa_viz.synthesis.search import outer, refusals, solve
from paminsa_viz.synthesis.search.case import SHAFT
from paminsa_viz.synthesis.search.evaluation import REFUSED
from paminsa_viz.synthesis.search.extremes import Extent
from paminsa_viz.synthesis.search.kernels import TORQUE_COLUMNS
from paminsa_viz.synthesis.search.outer import EXPLORE, PROGRESS, RegimeState, refined
from paminsa_viz.synthesis.search.refusals import least_footprint
from paminsa_viz.synthesis.search.region import SPARSE, ray, reach_margins
from paminsa_viz.synthesis.search.trial import ABOVE_QUILL, Poses, Robots, TrialRobot, _following
from paminsa_viz.synthesis.search.trial_masses import _tightened
from tests.synthesis.search_cases import CYLINDER
from tests.synthesis.test_costs import evaluator

SPACE = Workspace(WorkspaceShape.BOX, (0.2, 0.4, 0.3), (0.1, 0.0, -0.6))


def test_a_ray_from_the_very_edge_of_a_workspace_leaves_on_the_other_side() -> None:
    assert ray(SPACE, np.array([1.0, 0.0])) == pytest.approx(0.2)
    assert ray(SPACE, np.array([-1.0, 0.0])) == 0.0
    below = replace(SPACE, center=(0.0, -0.2, -0.6))
    assert ray(below, np.array([0.0, -1.0])) == pytest.approx(0.4)
    disc = Workspace(WorkspaceShape.CYLINDER, (0.2, 0.2, 0.3), (0.1, 0.0, -0.6))
    assert ray(disc, np.array([1.0, 0.0])) == pytest.approx(0.2)
    beyond = replace(disc, center=(0.1 + 1e-9, 0.0, -0.6))
    assert ray(beyond, np.array([1.0, 0.0])) == 0.0


# ---------------------------------------------------------------- what a trial is refused for


def test_a_footprint_that_is_just_large_enough_is_not_refused(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    for regime in Regime:
        least = least_footprint(CYLINDER, regime, 0.25)
        for most, refused in ((least, False), (least * (1 - 1e-9), True)):
            limited = replace(CYLINDER, limits=(ObjectiveLimit("footprint", most),))
            found = refusals._footprint(limited, regime, 0.25, "so it is")
            assert (found is not None) is refused
    # of two reasons for the same offset the first is named
    monkeypatch.setattr(refusals, "critical_radius", lambda condition: 1.0)
    far, reason = refusals._needed_offset(CYLINDER, Regime.SMALLER)
    assert far == pytest.approx(0.15)
    assert reason.startswith("the singular circle")


def test_drawn_bodies_that_lack_room_are_refused_by_what_is_missing() -> None:
    apart = Requirement("clearance", low=0.002)
    one = evaluator(apart, allow_overlap=False)
    numbers = np.array([[0.3, 0.1, 3.0, 0.5, 0.6, -0.6], [0.3, 0.1, 3.0, 0.5, 0.6, -0.55]])
    found = Robots.of(one.case, numbers)
    missing = found.missing_room(0.002)
    assert one._without_room(found) == pytest.approx(missing.sum(axis=1) / 1.1)
    assert missing.max() > 0.0
    more = replace(one, tighter=(0.05,))._without_room(found)
    assert more == pytest.approx(found.missing_room(0.052).sum(axis=1) / 1.1)
    assert (evaluator()._without_room(found) == 0.0).all()
    nothing = Robots.of(one.case, numbers[:0])
    assert one._without_room(nothing).shape == (0,)


def test_a_trial_is_never_worse_than_what_is_refused() -> None:
    trial: Any = SimpleNamespace(footprint=2 * REFUSED)
    one = evaluator()
    assert not one._is_worse(trial, REFUSED)
    assert one._is_worse(trial, 0.99 * REFUSED)


NUMBERS = np.array([[0.295, 0.085, 4.8, 0.79, 0.28, -0.77]])


def test_bounds_on_the_margin_of_reach_count_on_either_side() -> None:
    """The least of all limits in closed form; the largest, which seldom counts, at the samples."""
    margins = np.array([0.04, 0.03, 0.2, 0.1])
    low = Requirement("reach_margin", low=0.0005)
    one = evaluator(low)
    trial: Any = SimpleNamespace(footprint=0.5)
    found = one._over_poses(trial, margins, 0.1, np.inf)
    assert found.worst.tolist() == [0.03]
    high = Requirement("reach_margin", high=0.5)
    both = replace(evaluator(low, high, Requirement("condition", high=20.0)), density=SPARSE)
    (done,) = Robots.of(both.case, NUMBERS).trials(Poses(both.case), [0])
    ((index, (least, most)),) = both._others(done)
    assert index == 1
    assert Robots.of(both.case, NUMBERS).margins.min() == pytest.approx(least, abs=5e-3)
    assert least < most <= 0.8


# ---------------------------------------------------------------- trials with springs


def test_torques_with_springs_are_those_of_all_samples() -> None:
    held = np.random.default_rng(7).normal(size=(12, 4))
    trial: Any = SimpleNamespace(
        inner=SimpleNamespace(held=lambda pose: held), grid=lambda theta, heights: None
    )
    found = TrialRobot._sprung(trial, (0.0, 0.1), np.zeros(3))
    most = np.abs(held[:, :3]).max(axis=1)
    rms = np.sqrt((held[:, :3] ** 2).mean(axis=1))
    columns = np.column_stack([held, most, rms])
    np.testing.assert_allclose(found, [columns.min(axis=0), columns.max(axis=0)])
    assert np.isnan(TrialRobot._sprung(trial, (0.0, 0.1), np.zeros(0))).all()
    held[3, 1] = np.nan
    none = TrialRobot._sprung(trial, (0.0, 0.1), np.zeros(3))
    assert none.shape == (2, len(TORQUE_COLUMNS))
    assert (none[0] == -np.inf).all()
    assert (none[1] == np.inf).all()


@pytest.mark.parametrize(
    ("load", "bounds", "alike"),
    [
        (LoadCase(), (), True), (LoadCase(force_z=5.0), (), True),
        (LoadCase(force_x=1.0), (), False), (LoadCase(force_y=1.0), (), False),
        (LoadCase(moment_z=1.0), (), False),
        *((LoadCase(), (Requirement(f"tau_{i}", high=9.0),), False) for i in (1, 2, 3)),
        (LoadCase(), (Requirement("f_4", high=9.0), Requirement("max_torque", high=9.0)), True),
    ],
)  # fmt: skip
def test_legs_are_alike_unless_a_bound_or_a_load_tells_them_apart(
    load: LoadCase, bounds: Any, alike: bool
) -> None:
    case = replace(
        CYLINDER, reference=replace(APPENDIX_4, load=load),
        requirements=replace(CYLINDER.requirements, bounds=bounds),
    )  # fmt: skip
    assert Poses(case).alike is alike


def test_shafts_that_follow_keep_the_largest_clearance_that_is_asked_for() -> None:
    numbers = np.array([[0.3, 0.1, 3.0, 0.5, 0.6, -0.6]])

    def shaft(*bounds: Requirement) -> float:
        required = replace(CYLINDER.requirements, bounds=bounds)
        case = replace(CYLINDER, allow_overlap=False, requirements=required)
        robots = Robots.of(case, numbers)
        return float(_following(case, robots.geometries, robots.spans)["shaft_length"][0])

    base = shaft(Requirement("clearance", low=0.0))
    for low in (0.001, 0.02):
        bounds = (Requirement("clearance", low=low), Requirement("clearance", low=0.0005))
        assert shaft(*bounds) == pytest.approx(base + low)
        assert shaft(*bounds[::-1], Requirement("clearance", high=3.0)) == pytest.approx(base + low)
    # more than what the bodies need, by so much that others decide
    (trial,) = Robots.of(replace(CYLINDER, allow_overlap=False, clearance=0.0), numbers).geometries
    pose = Extent(CYLINDER.workspace_of(numbers[0]), CYLINDER.requirements.theta).samples(SPARSE)
    deep = np.abs(inverse_kinematics(trial, pose).points[5][..., 2]).max()
    needed = needed_shaft(APPENDIX_4, np.array([deep]), np.array([3.0]))
    assert trial.shaft_length == pytest.approx(needed[0] + ABOVE_QUILL) == pytest.approx(base)
    # bodies of half the size need half of what they take
    reference = APPENDIX_4.vary({"geometry.body_scale": 0.5})
    case = replace(CYLINDER, allow_overlap=False, clearance=0.0, reference=reference)
    (half,) = Robots.of(case, numbers).geometries
    needed = needed_shaft(reference, np.array([deep]), np.array([3.0]))
    assert half.shaft_length == pytest.approx(needed[0] + ABOVE_QUILL / 2)
    longer = trial.guide_link_length - half.guide_link_length
    assert longer == pytest.approx(needed_guide(np.zeros(1))[0] / 2)


@pytest.mark.parametrize("guide", list(Guide))
@pytest.mark.parametrize(
    ("changes", "follows"),
    [
        ({}, True), ({"allow_overlap": True}, False), ({"shaft_follows": False}, False),
        ({"ranges": (*CYLINDER.ranges, SearchRange(SHAFT, 0.1, 0.9))}, False),
    ],
)  # fmt: skip
def test_guides_and_shafts_follow_the_workspace_where_they_are_to(
    changes: dict[str, Any], follows: bool, guide: Guide
) -> None:
    """Guides as long as the farthest slider and the margin; all of the slider, if bodies count.

    The margin is that of the case, or what is required if that is more.
    """
    case = replace(CYLINDER, **{"allow_overlap": False, "guide": guide, "margin": 0.03} | changes)
    numbers = np.array([[0.3, 0.1, 3.0, 0.5, 0.6, -0.6, 0.2][: len(case.paths)]])
    (found,) = Robots.of(case, numbers).geometries
    pose = Extent(case.workspace_of(numbers[0]), case.requirements.theta).samples(SPARSE.finer(4))
    points = inverse_kinematics(found, pose).points
    slider = np.linalg.norm((points[8] - points[3])[..., :2], axis=-1).max()
    for margin, required in ((0.03, 0.0), (0.02, 0.03), (0.03, None), (0.001, 0.0)):
        bounds = (Requirement("condition", high=10.0), Requirement("reach_margin", required, 1.0))
        asked = replace(case.requirements, bounds=(*case.requirements.bounds, *bounds))
        (found,) = Robots.of(replace(case, margin=margin, requirements=asked), numbers).geometries
        if guide is Guide.KEPT:
            assert found.guide_link_length == APPENDIX_4.geometry.guide_link_length
            continue
        more = max(margin, required or 0.0, needed_guide(np.zeros(1))[0] if case.clear else 0.0)
        assert found.guide_link_length == pytest.approx(slider + more, abs=1e-4)
        assert reach_margins([found], Robots.of(case, numbers).spans)[0, 2] >= max(
            margin, required or 0.0
        )
    held = 0.2 if SHAFT in case.paths else APPENDIX_4.geometry.shaft_length
    assert (found.shaft_length != held) is follows


def test_guides_that_would_be_too_long_for_any_robot_are_as_long_as_one_may_be() -> None:
    numbers = np.array([[0.1001, 0.1, 1.001, 0.5, 0.6, -0.6]])
    (found,) = Robots.of(CYLINDER, numbers).geometries
    assert found.guide_link_length == LARGEST["m"]
    assert (Robots.of(CYLINDER, numbers).margins[:, 2] < 0.0).all()


def test_what_drawn_bodies_lack_is_that_of_the_poses_of_each_workspace() -> None:
    numbers = np.array([[0.3, 0.1, 3.0, 0.5, 0.6, -0.6], [0.295, 0.085, 4.8, 0.79, 0.28, -0.77]])
    robots = Robots.of(CYLINDER, numbers)
    found = robots.missing_room(0.05)
    for row, (geometry, space) in enumerate(zip(robots.geometries, robots.workspaces, strict=True)):
        pose = Extent(space, CYLINDER.requirements.theta).samples(SPARSE.finer(4))
        points = inverse_kinematics(geometry, pose).points
        rho = np.linalg.norm((points[5] - points[3])[..., :2], axis=-1)
        deep = np.abs(points[5][..., 2])
        apart = np.linalg.norm(points[8] - points[5], axis=-1)
        expected = missing_room(
            [geometry], rho.min(axis=(0, 1), keepdims=True)[0] / (geometry.magnification - 1.0),
            np.array([[deep.min(), deep.max()]]), np.array([[apart.min(), apart.max()]]), 0.05,
        )  # fmt: skip
        assert found[row] == pytest.approx(expected[0], abs=1e-3)
    assert (found.max(axis=1) > 0.01).all()


def test_a_trial_is_drawn_with_its_counterweights_and_bars_that_keep_their_masses() -> None:
    weights = (Counterweight("b8", 8, 0.1, 1.5),)
    (trial,) = Robots.of(CYLINDER, NUMBERS).trials(Poses(CYLINDER), [0])
    assert trial.drawn == replace(APPENDIX_4, geometry=trial.geometry)
    inner: Any = SimpleNamespace(design=replace(APPENDIX_4, counterweights=weights))
    own = replace(trial, inner=inner)
    assert own.drawn == replace(inner.design, geometry=trial.geometry)
    assert own.design is inner.design
    assert len(trial.radii) == 4
    assert trial.torques((0.0, 0.1), (3.0, 4.0)).shape == (2, len(TORQUE_COLUMNS))
    most = TORQUE_COLUMNS.index("max_torque")
    assert trial.static_torque == trial.torques(CYLINDER.requirements.theta)[1, most]


def test_plates_and_bars_are_looked_at_where_the_workspace_is() -> None:
    """At the height of the origin as well."""
    space = replace(SPACE, center=(0.0, 0.0, 0.0))
    geometry = APPENDIX_4.with_knee(KneeBranch.UPPER).geometry
    masses = np.zeros(28), np.zeros(18)

    def apart(z: float) -> float:
        placed = replace(space, center=(0.0, 0.0, z))
        trial = TrialRobot(Poses(CYLINDER), NUMBERS[0], geometry, placed, *masses)
        return trial.plate_distance((-0.1, 0.2), 1.0)

    assert apart(0.0) == pytest.approx(apart(1e-12), abs=1e-9)
    assert apart(0.0) != pytest.approx(apart(0.3), abs=1e-3)


def test_bounds_of_masses_are_tighter_by_what_the_solver_rounds() -> None:
    for value in (0.5, -0.5, 30.0, -30.0):
        spare = 2e-9 * max(1.0, abs(value))
        low = _tightened(Requirement("tau_1", low=value), 0.25)
        assert (low.low, low.high) == (pytest.approx(value + 0.25 + spare, abs=1e-12), None)
        high = _tightened(Requirement("tau_1", high=value), 0.25)
        assert (high.low, high.high) == (None, pytest.approx(value - 0.25 - spare, abs=1e-12))
        assert abs(low.low - value - 0.25) == pytest.approx(spare, rel=1e-4)  # type: ignore
        assert abs(high.high - value + 0.25) == pytest.approx(spare, rel=1e-4)  # type: ignore


# ---------------------------------------------------------------- rounds and regimes


def test_a_refinement_ends_where_a_round_gains_less_than_its_share(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    asked: list[Any] = []

    def play(costs: list[float]) -> int:
        asked.clear()

        def one(
            evaluator: Any, state: RegimeState, workers: Any, progress: Any, *, generations: int
        ) -> Any:
            asked.append((state, generations))
            return replace(state, history=(*state.history, costs[len(asked) - 1]), best=(0.5,) * 6)

        monkeypatch.setattr(outer, "search_round", one)
        monkeypatch.setattr(Evaluator, "evaluate", lambda self, numbers: ["done"])
        assert refined(case, Regime.SMALLER, NUMBERS[0].tolist()) == "done"
        assert {generations for _, generations in asked} == {15}
        assert 0 <= asked[0][0].generation - EXPLORE * case.effort.generations < 1
        return len(asked)

    case = replace(CYLINDER, effort=Effort(201))
    gain = 0.1 * PROGRESS
    assert play([0.0, 0.0, 0.0, 0.0]) == 2
    assert play([5.0, 4.0, 3.0, 2.0, 1.0]) == 4
    assert play([4.0 * (1 + 1.05 * gain), 4.0, 4.0, 4.0]) == 3
    assert play([4.0 * (1 + 0.9 * gain), 4.0, 1.0, 1.0]) == 2
    assert play([-4.0 * (1 - 2 * gain), -4.0, -4.0, -4.0]) == 3
    assert play([-4.0 * (1 - 0.9 * gain), -4.0, -9.0, -9.0]) == 2
    assert play([4.0 + gain * 4.0, 4.0, 1.0, 1.0]) == 2
    assert play([4.0, 4.0]) == 2


@pytest.mark.parametrize(
    ("feasible", "relax", "canceled", "asked"),
    [
        ((False, False), True, False, True), ((True, False), True, False, False),
        ((False, True), True, False, False), ((False, False), False, False, False),
        ((False, False), True, True, False),
    ],
)  # fmt: skip
def test_relaxations_are_looked_for_where_no_regime_has_an_answer(
    monkeypatch: pytest.MonkeyPatch, feasible: Any, relax: bool, canceled: bool, asked: bool
) -> None:
    called: list[Any] = []
    searched: list[Regime] = []

    class Run:
        def __init__(self, *_: Any, **__: Any) -> None:
            pass

        def search(self, state: RegimeState, note: Any) -> RegimeState:
            searched.append(state.regime)
            if canceled:
                raise Canceled
            note(state)
            return state

        def verify(self, state: RegimeState, *, repair: bool = True) -> Any:
            met = feasible[list(Regime).index(state.regime)]
            return SimpleNamespace(found=SimpleNamespace(feasible=met))

    monkeypatch.setattr(solve, "_Run", Run)
    monkeypatch.setattr(solve, "refusal", lambda *_: None)
    monkeypatch.setattr(solve, "_result", lambda *given: given)
    monkeypatch.setattr(solve, "relaxations", lambda *given: called.append(given) or ("x",))
    case = replace(CYLINDER, regimes=tuple(Regime))
    given = solve.synthesize(case, relax=relax)
    assert bool(called) is asked
    assert given[4] == (("x",) if asked else ())
    assert given[5] is canceled
    assert len(given[1]) == (0 if canceled else 2)
    assert searched == list(Regime)[: 1 if canceled else 2]
    if asked:
        assert called[0][1:3] == (tuple(Regime), here)


@pytest.mark.parametrize("knee", KneeBranch)
def test_samples_of_a_trial_are_at_its_own_heights(knee: KneeBranch) -> None:
    case = replace(CYLINDER, reference=APPENDIX_4.with_knee(knee))
    space = replace(SPACE, center=(0.0, 0.0, -0.6))
    trial: Any = SimpleNamespace(poses=Poses(case), case=case, workspace=space)
    whole = TrialRobot.heights(trial)
    assert whole == pytest.approx(-0.6 + 0.3 * np.linspace(-0.5, 0.5, 5))
    part = TrialRobot.heights(trial, (-0.65, 1.0))
    assert (part.min(), part.max(), len(part)) == (pytest.approx(-0.65), pytest.approx(-0.45), 5)
    part = TrialRobot.heights(trial, (-2.0, -0.75))
    assert part == pytest.approx(np.full(5, -0.75))
    assert TrialRobot.heights(trial, (-0.44, 0.0)).shape == (0,)
