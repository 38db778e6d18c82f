"""Balancing as pure functions of the state, and its outcomes in words."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from paminsa_viz.explorer import actions
from paminsa_viz.explorer.balancing import requests
from paminsa_viz.explorer.balancing.jobs import Task
from paminsa_viz.explorer.balancing.solving import middle, plane, run, standing, tidied
from paminsa_viz.explorer.balancing.wishes import Arm, Goal, Movable
from paminsa_viz.explorer.bounds import MOST_COUNTERWEIGHTS
from paminsa_viz.explorer.frame import compute, near_singularity
from paminsa_viz.explorer.maps import COARSE, MapStore, hold_range, toggle_difference
from paminsa_viz.explorer.motion import requests as motions
from paminsa_viz.explorer.panels.balance_front import FrontFigure, clicked_point
from paminsa_viz.explorer.panels.balance_tornado import TornadoFigure, words
from paminsa_viz.explorer.panels.balance_words import details_html, status_html
from paminsa_viz.explorer.panels.compare_panel import differences_html
from paminsa_viz.explorer.state import RangeMode, State, initial_state
from paminsa_viz.model import (
    APPENDIX_4,
    Design,
    InvalidDesign,
    InvalidInput,
    Limit,
    Quantity,
    balance_distance,
    check_reach,
    measure_singularity,
)
from paminsa_viz.model.balancing import OUTPUTS, InfeasibleBounds
from paminsa_viz.model.counterweight import Counterweight
from paminsa_viz.model.trajectory import analyse

HANGING = Counterweight("b8", 8, 0.1, 1.0)


@pytest.fixture(scope="module")
def start() -> State:
    return motions.choose_preset(initial_state(), "arch")


def solved(state: State, task: Task = Task.BEST) -> State:
    """Return the state after a task, done at once."""
    begun = requests.begin(state, task)
    assert begun.balancing.running is not None
    return requests.taken(begun, run(begun.balancing.running))


def with_design(state: State, design: Design) -> State:
    return actions.load_design(state, design)


def test_the_papers_balance_pins_the_design_before(start: State) -> None:
    start = actions.move(start, x=0.1, y=-0.05, theta=0.3)
    after = requests.balance_now(start)
    assert after.balancing.running is None
    assert balance_distance(after.document.design) == pytest.approx(0, abs=1e-12)
    assert after.document.reference == start.document.design
    assert after.document.design.joints.j7 == pytest.approx(3.063)
    frame = compute(after)
    assert np.abs(frame.torques[:3]).max() < 1e-9
    assert frame.reference_torques is not None
    assert np.abs(frame.reference_torques[:3]).max() > 0.1
    assert after.document.design.name != start.document.design.name
    # Once balanced there is nothing to change, and the reference stays what it was.
    again = requests.balance_now(after)
    assert again.document == after.document
    assert "nothing was changed" in status_html(again)
    taken_back = actions.restore(after, start.document)
    assert "the one before is shown again" in status_html(taken_back)


def test_its_numbers_are_the_models(start: State) -> None:
    after = requests.balance_now(start)
    outcome = after.balancing.outcome
    assert outcome is not None
    effects = {item.label: item for item in outcome.effects}
    motion = motions.planned(start).trajectory
    assert motion is not None
    for design, side in ((start.document.design, "before"), (after.document.design, "after")):
        torque = np.abs(analyse(design, motion).torque[:, :3])
        assert getattr(effects["peak torque in motion"], side) == pytest.approx(torque.max())
    mass = effects["mass of the robot"]
    assert mass.after - mass.before == pytest.approx(8.349)
    assert outcome.optimum is not None
    assert outcome.optimum.objective == pytest.approx(8.349)


def test_standing_is_looked_at_where_no_singularity_is_near(start: State) -> None:
    turned = actions.move(start, theta=0.5)
    job = requests.make_job(turned, Task.BEST)
    field = plane(job)
    used = field.status == Limit.OK
    assert used.any()
    poses = field.grid.poses()
    assert (poses[..., 2] == 0.5).all()
    assert not near_singularity(measure_singularity(field.geometry, poses[used])).any()
    torque = field.torques(APPENDIX_4)[:3][:, used]
    wanted = np.abs(torque).max(), np.sqrt(np.mean(torque**2))
    assert standing(job, APPENDIX_4) == pytest.approx(wanted)


@pytest.mark.parametrize("goal", list(Goal))
@pytest.mark.parametrize("movable", [Movable.NONE, Movable.ALL])
def test_every_goal_is_reached_within_its_bounds(
    start: State, goal: Goal, movable: Movable
) -> None:
    wished = requests.wish(requests.choose_goal(start, goal), movable=movable, lighter=0.1)
    after = solved(wished)
    outcome = after.balancing.outcome
    assert outcome is not None
    assert outcome.optimum is not None
    assert outcome.optimum.gap < 1e-6
    # The numbers of the table are those that were made small.
    effects = {item.label: item.after for item in outcome.effects}
    label = {Goal.PEAK: "peak torque in motion", Goal.RMS: "RMS torque in motion"}.get(goal)
    if label is not None:
        assert effects[label] == pytest.approx(outcome.optimum.objective, rel=1e-9)
    design = after.document.design
    for weight in design.counterweights:
        assert 0 <= weight.beyond <= 0.1
        assert 0 < weight.mass <= 5
    for path in ("links.b3", "joints.j7", "links.b1"):
        held = APPENDIX_4.value(path)
        low, high = (0.9 * held, held + 5) if movable is Movable.ALL else (held, held)
        assert low - 1e-9 <= design.value(path) <= high + 1e-9
    if goal.static:
        assert balance_distance(design) == pytest.approx(0, abs=1e-9)
    else:
        assert wished.balancing.wishes.exact is False
    text = status_html(after) + details_html(outcome)
    assert "Proved" in text
    assert "nan" not in text


def test_what_did_not_change_keeps_its_last_digit(start: State) -> None:
    wished = requests.wish(start, movable=Movable.PANTOGRAPH, arm_b8=Arm(0.1, 0))
    design = solved(wished).document.design
    assert design.inertias == APPENDIX_4.inertias


def test_impossible_bounds_are_told_with_what_to_relax(start: State) -> None:
    wished = requests.wish(start, arm_b3=Arm(0.1, 0.0), arm_b8=Arm(0.1, 0.5))
    after = solved(wished)
    assert after.document == start.document
    outcome = after.balancing.outcome
    assert outcome is not None
    assert isinstance(outcome.problem, InfeasibleBounds)
    text = status_html(after)
    assert "The bounds do not allow it" in text
    assert "<b>raise</b> weight on B8 past 8 from 0.5 to 3.896 kg" in text
    assert details_html(outcome) == ""
    # What it says would do does, and the refusal goes as soon as something is changed.
    relaxed = requests.wish(after, arm_b8=Arm(0.1, 3.897))
    assert relaxed.balancing.outcome is None
    assert balance_distance(solved(relaxed).document.design) == pytest.approx(0, abs=1e-9)
    near = solved(requests.wish(after, exact=False))
    assert balance_distance(near.document.design) == pytest.approx(7.93255, abs=1e-5)
    assert "As near to balance" in status_html(near)


def test_without_a_motion_it_says_so(start: State) -> None:
    table = motions.choose_kind(start, motions.Kind.TABLE)
    after = solved(requests.choose_goal(table, Goal.PEAK))
    assert "CSV" in status_html(after)
    # The balance itself needs none.
    assert "Balanced" in status_html(requests.balance_now(table))
    assert "–" in details_html(requests.balance_now(table).balancing.outcome)


def test_nothing_that_may_change_is_refused(start: State) -> None:
    none = requests.wish(start, arm_b3=Arm(), arm_b8=Arm())
    assert "give counterweights a mass" in status_html(solved(none))


def test_a_design_changed_in_the_meantime_is_not_overwritten(start: State) -> None:
    begun = requests.begin(start, Task.BEST)
    job = begun.balancing.running
    assert job is not None
    with pytest.raises(InvalidInput, match="still runs"):
        requests.begin(begun, Task.FRONT)
    changed = actions.vary(begun, {"links.b4": 0.9})
    after = requests.taken(changed, run(job))
    assert after.document == changed.document
    assert "changed in the meantime" in status_html(after)
    # And one that was stopped is dropped.
    stopped = requests.stop(begun)
    assert requests.taken(stopped, run(job)) is stopped


def test_existing_counterweights_may_give_way_to_better_ones(start: State) -> None:
    poor = with_design(start, replace(APPENDIX_4, counterweights=(Counterweight("b4", 5, 0, 2.0),)))
    design = solved(poor).document.design
    assert all(weight.bar != "b4" for weight in design.counterweights)


@given(st.lists(st.sampled_from([0.0, 0.1, 0.2]), max_size=5), st.integers(0, 10**6))
def test_tidying_keeps_the_mechanics(places: list[float], seed: int) -> None:
    masses = np.random.default_rng(seed).choice([0.0, 0.3, 1.1], size=len(places))
    weights = tuple(
        Counterweight("b3", 7, place, float(mass))
        for place, mass in zip(places, masses, strict=True)
    )
    design = replace(APPENDIX_4, counterweights=weights)
    tidy = tidied(design)
    assert balance_distance(tidy) == pytest.approx(balance_distance(design), abs=1e-9)
    kept = [(weight.bar, weight.joint, weight.beyond) for weight in tidy.counterweights]
    assert len(kept) == len(set(kept))
    assert all(weight.mass > 0 for weight in tidy.counterweights)


@pytest.mark.parametrize(
    "change",
    [
        {"heavier": -1.0},
        {"heavier": float("nan")},
        {"lighter": 1.5},
        {"share": 2.0},
        {"arm_b8": Arm(2.0, 1.0)},
        {"arm_b3": Arm(0.1, -1.0)},
        {"added": 1e6},
    ],
)
def test_numbers_out_of_range_are_refused(start: State, change: dict[str, object]) -> None:
    with pytest.raises(InvalidInput, match="is possible"):
        requests.wish(start, **change)


def test_the_front_is_gone_along_point_by_point(start: State) -> None:
    steps: list[float] = []
    begun = requests.begin(start, Task.FRONT)
    job = begun.balancing.running
    assert job is not None
    outcome = run(job, lambda done: bool(steps.append(done)))
    assert steps == sorted(steps)
    assert steps[-1] == 1
    after = requests.taken(begun, outcome)
    assert after.document == start.document
    front = outcome.front
    assert front is not None
    assert len(outcome.designs) == len(front.points) > 5
    assert requests.chosen_point(after) is None
    for index in (0, 4, len(front.points) - 1):
        point = front.points[index]
        after = requests.choose_point(after, index)
        assert requests.chosen_point(after) == index
        assert after.document.reference == start.document.design
        torque = analyse(after.document.design, job.trajectory).torque[:, :3]  # type: ignore[arg-type]
        assert np.abs(torque).max() == pytest.approx(point.first, rel=1e-6)
        still = standing(job, after.document.design)[0]
        assert still == pytest.approx(point.second, rel=1e-6, abs=1e-7)
        assert clicked_point({"x": point.first, "y": point.second}, outcome) == index
        marks = json.loads(FrontFigure(outcome, index).to_json())["data"][0]["marker"]["size"]
        assert marks.index(max(marks)) == index
    with pytest.raises(InvalidInput, match="no such point"):
        requests.choose_point(after, len(front.points))
    assert clicked_point({"x": 1e6, "y": 0}, outcome) is None
    assert clicked_point({"x": "1", "y": 0}, outcome) is None
    assert clicked_point([1], outcome) is None


def test_a_front_that_is_stopped_stops(start: State) -> None:
    begun = requests.begin(start, Task.FRONT)
    job = begun.balancing.running
    assert job is not None
    outcome = run(job, lambda _: True)
    assert outcome.front is not None
    assert len(outcome.front.points) < 3


def test_the_tornado_has_the_longest_bar_on_top(start: State) -> None:
    loaded = requests.add_weight(requests.add_weight(start, "b8", 8), "b3", 7)
    after = solved(loaded, Task.TORNADO)
    outcome = after.balancing.tornado
    assert outcome is not None
    assert outcome.tornado is not None
    for output in range(len(OUTPUTS)):
        tree = json.loads(TornadoFigure(outcome.tornado, output).to_json())
        lengths = np.abs([trace["x"] for trace in tree["data"]]).max(axis=0)
        assert len(lengths) > 5
        assert (np.diff(lengths) <= 1e-12).all()
        names = tree["data"][0]["y"]
        assert len(names) == len(set(names))
    assert "counterweight 2" in json.dumps(TornadoFigure(outcome.tornado, 0).to_json())
    # What it says of m_7 is what a design with another m_7 has.
    bar = next(bar for bar in outcome.tornado.bars if bar.path == "joints.j7")
    more = loaded.document.design.vary({"joints.j7": 1.05 * bar.value})
    assert bar.plus[0] == pytest.approx(balance_distance(more))
    assert "Of an earlier design" in words(requests.hang(after, ()))
    with pytest.raises(InvalidInput):
        requests.show_output(after, 9)


def test_the_tornado_looks_at_clear_poses(start: State) -> None:
    job = requests.make_job(start, Task.TORNADO)
    poses = middle(job).poses()
    geometry = APPENDIX_4.geometry
    assert check_reach(geometry, poses).ok.all()
    assert not near_singularity(measure_singularity(geometry, poses)).any()
    far = solved(actions.move(start, z=-3.0), Task.TORNADO)
    assert "no pose around the middle is clear" in words(far)


def test_without_a_motion_the_tornado_says_what_it_can(start: State) -> None:
    table = motions.choose_kind(start, motions.Kind.TABLE)
    after = solved(table, Task.TORNADO)
    assert "Nothing to show" not in words(after)
    assert "Nothing to show" in words(requests.show_output(after, 3))


def test_one_scale_suits_both_designs(start: State) -> None:
    after = requests.balance_now(start)
    held = hold_range(after)
    assert held.map_view.range_mode is RangeMode.MANUAL
    assert held.map_view.high == -held.map_view.low > 1
    store = MapStore()
    shown = [held, actions.swap_reference(held), toggle_difference(held)]
    scales = [store.scales(s, store.data(s)) for s in shown]
    assert scales[0] == scales[1] == scales[2]
    # Where nothing can be negative, no colours are spent on it.
    quantities, alone = (Quantity.MAX_TORQUE,), hold_range(start)
    (scale,) = store.scales(alone, store.data(alone, COARSE, quantities), quantities)
    assert scale.low == 0
    assert not toggle_difference(toggle_difference(held)).map_view.difference


def test_counterweights_are_hung_changed_and_taken_off(start: State) -> None:
    one = requests.add_weight(start, "b8", 8)
    assert one.document.design.counterweights == (HANGING,)
    two = requests.add_weight(one, "b3", 7)
    moved = requests.set_weight(two, 1, 2.5, 0.15)
    assert moved.document.design.counterweights == (HANGING, Counterweight("b3", 7, 0.15, 2.5))
    assert requests.set_weight(moved, 5, 1.0, 0.1) is moved
    with pytest.raises(InvalidDesign):
        requests.set_weight(moved, 0, -1.0, 0.1)
    assert requests.drop_weight(moved, 0).document.design.counterweights == (
        Counterweight("b3", 7, 0.15, 2.5),
    )
    assert requests.drop_weight(moved, -1) is moved
    assert requests.hang(moved, ()).document == start.document
    full = requests.hang(start, (HANGING,) * MOST_COUNTERWEIGHTS)
    with pytest.raises(InvalidDesign, match="at most"):
        requests.add_weight(full, "b8", 8)


def test_the_comparison_names_counterweights() -> None:
    design = replace(APPENDIX_4, counterweights=(HANGING,))
    text = differences_html(design, APPENDIX_4, "App. 4")
    assert "on B8, 100 mm beyond joint 8" in text
    assert "1 number differs" in text
    assert "No number differs" in differences_html(design, design, "reference")
