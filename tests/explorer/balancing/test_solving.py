"""Balancing as pure functions of the state, and its outcomes in words."""

from __future__ import annotations

import numpy as np
import pytest

from paminsa_viz.explorer import actions
from paminsa_viz.explorer.balancing import actions as balancing
from paminsa_viz.explorer.balancing.jobs import CounterweightSlot, FreeMasses, Goal, Task
from paminsa_viz.explorer.balancing.solving import plane, run, static_torque
from paminsa_viz.explorer.frame import compute, near_singularity
from paminsa_viz.explorer.maps import COARSE, MapStore, hold_range, toggle_difference
from paminsa_viz.explorer.motion import actions as motions
from paminsa_viz.explorer.panels.balance_text import details_html
from paminsa_viz.explorer.state import RangeMode, State
from paminsa_viz.model import (
    APPENDIX_4,
    InvalidInput,
    Limit,
    measure_singularity,
    static_imbalance,
)
from paminsa_viz.trajectory import analyze
from tests.explorer.balancing.balanced import solved, status


def test_the_papers_balance_pins_the_design_before(start: State) -> None:
    start = actions.move(start, x=0.1, y=-0.05, theta=0.3)
    after = balancing.balance_now(start)
    assert after.balancing.running is None
    assert static_imbalance(after.document.design) == pytest.approx(0, abs=1e-12)
    assert after.document.reference == start.document.design
    assert after.document.design.joints.j7 == pytest.approx(3.063)
    frame = compute(after)
    assert np.abs(frame.torques[:3]).max() < 1e-9
    assert frame.reference_torques is not None
    assert np.abs(frame.reference_torques[:3]).max() > 0.1
    assert after.document.design.name != start.document.design.name
    # Once balanced there is nothing to change, and the reference stays what it was.
    again = balancing.balance_now(after)
    assert again.document == after.document
    assert "nothing was changed" in status(again)
    taken_back = actions.restore(after, start.document)
    assert "the one before is shown again" in status(taken_back)


def test_its_numbers_are_the_models(start: State) -> None:
    after = balancing.balance_now(start)
    outcome = after.balancing.outcome
    assert outcome is not None
    effects = {item.label: item for item in outcome.effects}
    motion = motions.planned(start).trajectory
    assert motion is not None
    for design, side in ((start.document.design, "before"), (after.document.design, "after")):
        torque = np.abs(analyze(design, motion).torque[:, :3])
        assert getattr(effects["peak dynamic torque"], side) == pytest.approx(torque.max())
    mass = effects["mass of the robot"]
    assert mass.after - mass.before == pytest.approx(8.349)
    assert outcome.optimum is not None
    assert outcome.optimum.objective == pytest.approx(8.349)


def test_standing_is_looked_at_where_no_singularity_is_near(start: State) -> None:
    turned = actions.move(start, theta=0.5)
    job = balancing.make_job(turned, Task.OPTIMUM)
    field = plane(job)
    used = field.status == Limit.OK
    assert used.any()
    poses = field.grid.poses()
    assert (poses[..., 2] == 0.5).all()
    assert not near_singularity(measure_singularity(field.geometry, poses[used])).any()
    torque = field.torques(APPENDIX_4)[:3][:, used]
    wanted = np.abs(torque).max(), np.sqrt(np.mean(torque**2))
    assert static_torque(job, APPENDIX_4) == pytest.approx(wanted)


@pytest.mark.parametrize("goal", list(Goal))
@pytest.mark.parametrize("movable", [FreeMasses.NONE, FreeMasses.ALL])
def test_every_goal_is_reached_within_its_bounds(
    start: State, goal: Goal, movable: FreeMasses
) -> None:
    wished = balancing.change_settings(
        balancing.choose_goal(start, goal), movable=movable, max_decrease=0.1
    )
    after = solved(wished)
    outcome = after.balancing.outcome
    assert outcome is not None
    assert outcome.optimum is not None
    assert outcome.optimum.gap < 1e-6
    # The numbers of the table are those that were made small.
    effects = {item.label: item.after for item in outcome.effects}
    label = {Goal.PEAK: "peak dynamic torque", Goal.RMS: "RMS dynamic torque"}.get(goal)
    if label is not None:
        assert effects[label] == pytest.approx(outcome.optimum.objective, rel=1e-9)
    design = after.document.design
    for weight in design.counterweights:
        assert 0 <= weight.beyond <= 0.1
        assert 0 < weight.mass <= 5
    for path in ("links.b3", "joints.j7", "links.b1"):
        held = APPENDIX_4.value(path)
        low, high = (0.9 * held, held + 5) if movable is FreeMasses.ALL else (held, held)
        assert low - 1e-9 <= design.value(path) <= high + 1e-9
    if goal.static:
        assert static_imbalance(design) == pytest.approx(0, abs=1e-9)
    else:
        assert wished.balancing.settings.exact is False
    text = status(after) + details_html(outcome)
    assert "Certified optimal" in text
    assert "nan" not in text


def test_what_did_not_change_keeps_its_last_digit(start: State) -> None:
    wished = balancing.change_settings(
        start, movable=FreeMasses.PANTOGRAPH, slot_b8=CounterweightSlot(0.1, 0)
    )
    design = solved(wished).document.design
    assert design.inertias == APPENDIX_4.inertias


def test_a_design_changed_in_the_meantime_is_not_overwritten(start: State) -> None:
    started = balancing.start(start, Task.OPTIMUM)
    job = started.balancing.running
    assert job is not None
    with pytest.raises(InvalidInput, match="still runs"):
        balancing.start(started, Task.FRONT)
    changed = actions.vary(started, {"links.b4": 0.9})
    after = balancing.receive_result(changed, run(job))
    assert after.document == changed.document
    assert "changed in the meantime" in status(after)
    # And one that was stopped is dropped.
    stopped = balancing.stop(started)
    assert balancing.receive_result(stopped, run(job)) is stopped


def test_one_scale_suits_both_designs(start: State) -> None:
    after = balancing.balance_now(start)
    held = hold_range(after)
    assert held.map_view.range_mode is RangeMode.MANUAL
    assert held.map_view.high == -held.map_view.low > 1
    store = MapStore()
    shown = [held, actions.swap_reference(held), toggle_difference(held)]
    scales = [store.scales(s, store.data(s)) for s in shown]
    assert scales[0] == scales[1] == scales[2]
    # Where nothing can be negative, no colors are spent on it.
    quantities, alone = ("max_torque",), hold_range(start)
    (scale,) = store.scales(alone, store.data(alone, COARSE, quantities), quantities)
    assert scale.low == 0
    assert not toggle_difference(toggle_difference(held)).map_view.difference
