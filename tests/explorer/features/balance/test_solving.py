"""Balancing as pure functions of the state: optima, their texts, what cannot be balanced."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from paminsa_viz.balancing import InfeasibleBounds
from paminsa_viz.blocks.balance import effects_table, optimum_blocks
from paminsa_viz.blocks.maps import maps_data
from paminsa_viz.explorer.core import actions
from paminsa_viz.explorer.core import motion as motions
from paminsa_viz.explorer.core.frame import compute
from paminsa_viz.explorer.core.maps import COARSE, MapStore, hold_range, toggle_difference
from paminsa_viz.explorer.features.balance import actions as balancing
from paminsa_viz.explorer.features.balance.solving import run, static_torque, tidied
from paminsa_viz.explorer.features.balance.texts import details_html
from paminsa_viz.explorer.features.compare.tab import differences_html
from paminsa_viz.explorer.state.balance import BalanceKind, CounterweightSlot, FreeMasses, Goal
from paminsa_viz.explorer.state.maps import RangeMode
from paminsa_viz.explorer.state.outcome import solve
from paminsa_viz.explorer.state.state import State
from paminsa_viz.model import (
    APPENDIX_4,
    InvalidDesign,
    InvalidInput,
    Limit,
    measure_singularity,
    static_imbalance,
)
from paminsa_viz.model.parameters import MOST_COUNTERWEIGHTS, Counterweight
from paminsa_viz.quantities import TORQUES
from paminsa_viz.trajectory import analyze
from paminsa_viz.units import format_value
from tests.explorer.features.balance.balanced import ATTACHED, START, solved, started, status
from tests.support.tables import assert_parts
from tests.support.tasks import delivered


def test_papers_balance_pins_the_design_before() -> None:
    start = actions.move(START, x=0.1, y=-0.05, theta=0.3)
    after = balancing.balance_now(start)
    assert after.balance.running is None
    assert static_imbalance(after.document.design) == pytest.approx(0, abs=1e-12)
    assert after.document.reference == start.document.design
    assert after.document.design.joints.j7 == pytest.approx(3.063)
    assert after.document.design.name != start.document.design.name
    frame = compute(after)
    assert np.abs(frame.torques[:3]).max() < 1e-9
    assert frame.reference_torques is not None
    assert np.abs(frame.reference_torques[:3]).max() > 0.1
    # Once balanced there is nothing to change, and the reference stays what it was.
    again = balancing.balance_now(after)
    assert again.document == after.document
    assert "nothing was changed" in status(again)
    assert "The one before is shown again" in status(actions.restore(after, start.document))


def test_numbers_of_a_result_are_the_models() -> None:
    after = balancing.balance_now(START)
    outcome, motion = after.balance.outcome, motions.planned(START).trajectory
    assert outcome is not None
    found = outcome.result
    assert found is not None
    assert motion is not None
    effects = {(item.group, item.label): item for item in found.effects}
    mass = effects["", "mass with payload"]
    for side, state in (("before", START), ("after", after)):
        design = state.document.design
        loads = analyze(design, motion)
        maps = [MapStore().data(state, quantities=keys) for keys in (TORQUES, ("f_4",))]
        static = [
            [item["least"], item["largest"]]  # as `paminsa-viz map` prints them
            for data, keys in zip(maps, (TORQUES, ("f_4",)), strict=True)
            for item in maps_data(data, keys, state.condition_limit)["maps"].values()
        ]
        for j in range(4):
            name = f"M{j + 1}"
            for group, values in (
                ("largest at rest", static[j]),
                ("largest in motion", loads.torque[:, j]),
                ("largest power", loads.power[:, j]),
            ):
                size = getattr(effects[group, name], side)
                assert size == pytest.approx(np.abs(values).max(), abs=1e-9)
    # M4 carries the counterweights: that is the price of a balance.
    assert effects["largest at rest", "M4"].after > 1.2 * effects["largest at rest", "M4"].before
    price = r"The price: M4: largest at rest \+2\d\.\d %, largest in motion \+\d\d\.\d %"
    assert re.search(price, status(after))
    assert mass.after - mass.before == pytest.approx(found.optimum.objective)
    assert found.optimum.objective == pytest.approx(8.349)


def test_static_torque_is_that_of_all_poses_away_from_singularities() -> None:
    job = balancing.make_job(actions.move(START, theta=0.5), BalanceKind.OPTIMUM)
    field = job.plane(COARSE)
    used = field.status == Limit.OK
    poses = field.grid.poses()
    assert used.any()
    assert (poses[..., 2] == 0.5).all()
    measured = measure_singularity(APPENDIX_4.geometry, poses[used])
    assert (measured.condition <= 10).all()
    assert (measured.serial_distance >= 0.01).all()
    wanted = np.abs(field.torques(APPENDIX_4)[:3][:, used]).max()
    assert static_torque(job, APPENDIX_4) == pytest.approx(wanted)


@pytest.mark.slow
@pytest.mark.parametrize("goal", Goal)
@pytest.mark.parametrize("movable", [FreeMasses.NONE, FreeMasses.ALL])
def test_every_goal_is_optimal_within_its_bounds(goal: Goal, movable: FreeMasses) -> None:
    chosen = balancing.choose_goal(START, goal)
    after = solved(balancing.change_settings(chosen, movable=movable, max_decrease=0.1))
    outcome, design = after.balance.outcome, after.document.design
    assert outcome is not None
    found = outcome.result
    assert found is not None
    assert found.optimum.gap < 1e-6
    effects = {(item.group, item.label): item.after for item in found.effects}
    group = {Goal.PEAK: "largest in motion", Goal.RMS: "RMS in motion"}.get(goal)
    if group is not None:
        sizes = np.array([effects[group, f"M{number}"] for number in (1, 2, 3)])
        value = sizes.max() if goal is Goal.PEAK else np.sqrt(np.mean(sizes**2))
        assert value == pytest.approx(found.optimum.objective, rel=1e-9)
    if goal is Goal.ENERGY:
        (moved,) = found.optimum.values
        assert moved.unit == "J"
        assert moved.after == pytest.approx(found.optimum.objective)
        assert moved.after <= moved.before
    for weight in design.counterweights:
        assert 0 <= weight.beyond <= 0.1
        assert 0 < weight.mass <= 5
    for path in ("links.b3", "joints.j7", "links.b1"):
        given = APPENDIX_4.value(path)
        low, high = (0.9 * given, given + 5) if movable is FreeMasses.ALL else (given, given)
        assert low - 1e-9 <= design.value(path) <= high + 1e-9
    if goal.static:
        assert static_imbalance(design) == pytest.approx(0, abs=1e-9)
    assert chosen.balance.settings.exact is goal.static
    assert_parts(
        details_html(outcome), [*optimum_blocks(found.optimum), effects_table(found.effects)]
    )
    text = status(after) + details_html(outcome)
    data = MapStore().data(after, quantities=TORQUES)
    place = f"θ = {format_value(data.theta, 'rad')}, z = {format_value(data.z, 'm')} that count"
    assert place in text  # as below a map
    assert "Certified optimal" in text
    assert "nan" not in text


def test_unchanged_numbers_keep_their_last_digit() -> None:
    slot = CounterweightSlot(0.1, 0)
    wanted = balancing.change_settings(START, movable=FreeMasses.PANTOGRAPH, slot_b8=slot)
    assert solved(wanted).document.design.inertias == APPENDIX_4.inertias


@pytest.mark.slow
def test_result_for_another_design_or_a_stopped_job_is_dropped() -> None:
    running, job = started(START, BalanceKind.OPTIMUM)
    with pytest.raises(InvalidInput, match="still runs"):
        balancing.start(running, BalanceKind.FRONT)
    changed = actions.vary(running, {"links.b4": 0.9})
    after = delivered(balancing.OPTIMUM, changed, solve(run, job))
    assert after.document == changed.document
    assert "changed in the meantime" in status(after)
    stopped = balancing.OPTIMUM.stop(running)
    assert delivered(balancing.OPTIMUM, stopped, solve(run, job)) is stopped


def test_common_range_suits_both_designs() -> None:
    after = balancing.balance_now(START)
    held, store = hold_range(after), MapStore()
    assert held.map_view.range_mode is RangeMode.MANUAL
    assert held.map_view.high == -held.map_view.low > 1
    shown = [held, actions.swap_reference(held), toggle_difference(held)]
    first, *others = (store.scales(s, store.data(s)) for s in shown)
    assert others == [first, first]
    # Where nothing can be negative, no colors are spent on it.
    quantities, alone = ("max_torque",), hold_range(START)
    (scale,) = store.scales(alone, store.data(alone, COARSE, quantities), quantities)
    assert scale.low == 0
    assert not toggle_difference(toggle_difference(held)).map_view.difference


def slots(b3: float, b8: float) -> State:
    """Return the start with these largest counterweights [kg], no other mass free."""
    b3_slot, b8_slot = (CounterweightSlot(0.1, mass) for mass in (b3, b8))
    return balancing.change_settings(START, slot_b3=b3_slot, slot_b8=b8_slot)


@pytest.mark.slow
def test_infeasible_bounds_are_reported_with_what_to_relax() -> None:
    after = solved(slots(0.0, 0.5))
    outcome = after.balance.outcome
    assert after.document == START.document
    assert outcome is not None
    assert isinstance(outcome.error, InfeasibleBounds)
    text = status(after)
    assert "The bounds do not allow it" in text
    assert "Raise the upper bound of weight on B8 past 8 from 0.5 kg to 3.8962 kg" in text
    assert details_html(outcome) == ""
    # What is suggested suffices; the report goes once something is changed, and only then.
    relaxed = balancing.change_settings(after, slot_b8=CounterweightSlot(0.1, 3.897))
    assert relaxed.balance.outcome is None
    assert static_imbalance(solved(relaxed).document.design) == pytest.approx(0, abs=1e-9)
    assert balancing.change_settings(after, slot_b8=CounterweightSlot(0.1, 0.5)) is after
    near = solved(balancing.change_settings(after, exact=False))
    assert static_imbalance(near.document.design) == pytest.approx(7.93255, abs=1e-5)
    assert "As near to balance" in status(near)


def test_missing_motion_and_missing_freedom_are_reported() -> None:
    table = motions.choose_kind(START, motions.Kind.TABLE)
    assert "<br>Choose a CSV file" in status(solved(balancing.choose_goal(table, Goal.PEAK)))
    balanced = balancing.balance_now(table)  # needs no motion
    assert "Statically balanced" in status(balanced)
    assert "–" in details_html(balanced.balance.outcome)
    assert "give counterweights a mass" in status(solved(slots(0.0, 0.0)))


def test_existing_counterweights_may_be_replaced() -> None:
    poor = replace(APPENDIX_4, counterweights=(Counterweight("b4", 5, 0, 2.0),))
    design = solved(actions.load_design(START, poor)).document.design
    assert all(weight.bar != "b4" for weight in design.counterweights)


@given(
    st.lists(
        st.builds(
            Counterweight,
            st.just("b3"), st.just(7),
            st.sampled_from([0.0, 0.1, 0.2]), st.sampled_from([0.0, 0.3, 1.1]),
        ),
        max_size=5,
    )
)  # fmt: skip
def test_merged_counterweights_keep_the_imbalance(weights: list[Counterweight]) -> None:
    design = replace(APPENDIX_4, counterweights=tuple(weights))
    tidy = tidied(design)
    assert static_imbalance(tidy) == pytest.approx(static_imbalance(design), abs=1e-9)
    kept = [(weight.bar, weight.joint, weight.beyond) for weight in tidy.counterweights]
    assert len(kept) == len(set(kept))
    assert all(weight.mass > 0 for weight in tidy.counterweights)


def test_counterweights_are_attached_changed_and_removed() -> None:
    def weights(state: State) -> tuple[Counterweight, ...]:
        return state.document.design.counterweights

    one = balancing.add_counterweight(START, "b8", 8)
    assert weights(one) == (ATTACHED,)
    moved = balancing.change_counterweight(balancing.add_counterweight(one, "b3", 7), 1, 2.5, 0.15)
    other = Counterweight("b3", 7, 0.15, 2.5)
    assert weights(moved) == (ATTACHED, other)
    assert balancing.change_counterweight(moved, 5, 1.0, 0.1) is moved
    assert weights(balancing.remove_counterweight(moved, 0)) == (other,)
    assert balancing.remove_counterweight(moved, -1) is moved
    assert actions.change_design(moved, counterweights=()).document == START.document
    full = actions.change_design(START, counterweights=(ATTACHED,) * MOST_COUNTERWEIGHTS)
    for impossible in (
        lambda: balancing.change_counterweight(moved, 0, -1.0, 0.1),
        lambda: balancing.add_counterweight(full, "b8", 8),
    ):
        with pytest.raises(InvalidDesign):
            impossible()


def test_comparison_names_counterweights() -> None:
    design = replace(APPENDIX_4, counterweights=(ATTACHED,))
    text = differences_html(design, APPENDIX_4, "App. 4")
    assert "on B8, 100 mm beyond joint 8" in text
    assert "1 number differs" in text
    assert "No number differs" in differences_html(design, design, "reference")
