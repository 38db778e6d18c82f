"""The paper's balance: exact where the bounds allow it, nearest elsewhere."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from paminsa_viz.balancing import (
    AddedMass,
    Changes,
    InfeasibleBounds,
    MassChange,
    MassRange,
    balance,
    beyond,
    whole_mass,
)
from paminsa_viz.balancing.program import SolverFailed
from paminsa_viz.model import (
    APPENDIX_4,
    Counterweight,
    Design,
    InvalidDesign,
    KneeBranch,
    lift_constant,
    static_imbalance,
    static_torques,
)
from tests import oracle
from tests.balancing.weighted import on_the_bars
from tests.support import samples
from tests.support.cases import BOTH, Case, cases
from tests.support.samples import with_knee

pytestmark = pytest.mark.slow


TIGHT = Changes((MassRange("joints.j7", 0.1, 1.5), MassRange("joints.j9", 0.2, 0.3)))
"""Bounds within which M_p2 cannot vanish."""


def balanced() -> list[Design]:
    """Designs balanced in three ways: the paper's masses, weights beyond 7, weights beyond 8."""
    ranges = [
        Changes((), (beyond(bar, joint, 0.15, 20.0),)) for bar, joint in (("b3", 7), ("b8", 8))
    ]
    return [balance(APPENDIX_4).after, *(balance(APPENDIX_4, one).after for one in ranges)]


@BOTH
def test_balanced_designs_need_no_static_torque_at_100000_poses(knee: KneeBranch) -> None:
    poses = np.random.default_rng(0).uniform(
        (-0.3, -0.3, -1.2, -0.9), (0.3, 0.3, 1.2, 0.9), (250_000, 4)
    )
    before = static_torques(with_knee(APPENDIX_4, knee), poses)
    reached = np.isfinite(before).all(axis=1)
    poses, before = poses[reached], before[reached, :3]
    assert len(poses) >= 100_000
    largest = np.abs(before).max(axis=1, keepdims=True)
    for design in balanced():
        torque = static_torques(with_knee(design, knee), poses)
        assert (np.abs(torque[:, :3]) <= 1e-14 * largest).all()
        np.testing.assert_allclose(torque[:, 3], lift_constant(design), rtol=1e-12)


@BOTH
def test_balance_agrees_with_first_principles(knee: KneeBranch) -> None:
    poses = samples.random_poses(np.random.default_rng(1), with_knee(APPENDIX_4, knee), 50)
    before = np.abs(oracle.static_torques(with_knee(APPENDIX_4, knee), poses)[:, :3]).max()
    with on_the_bars():
        for design in balanced():
            assert (
                np.abs(oracle.static_torques(with_knee(design, knee), poses)[:, :3]).max()
                < 1e-11 * before
            )


@given(case=cases(), moved=st.booleans())
def test_any_robot_can_be_balanced(case: Case, moved: bool) -> None:
    criterion = MassChange() if moved else AddedMass()
    result = balance(case.design, criterion=criterion)
    design = result.after
    scale = case.design.gravity * whole_mass(case.design)
    assert abs(static_imbalance(design)) < 1e-15 * scale
    assert result.gap <= 1e-9
    added = whole_mass(design) - whole_mass(case.design)
    assert result.values[1].after == pytest.approx(added, abs=1e-9)
    assert result.objective == pytest.approx(added, abs=1e-9)


def test_appendix_4_is_balanced_by_joint_7() -> None:
    """m_7 has the largest share of those that pull the other way, -g/k for a kg."""
    result = balance(APPENDIX_4)
    assert result.after == APPENDIX_4.vary({"joints.j7": result.after.joints.j7})
    assert result.after.joints.j7 == pytest.approx(0.28 + 3 * 9.10041 / 9.81, abs=1e-12)
    assert {item.name for item in result.active if item.side == "low"} == {
        "joints.j4", "joints.j9", "links.b3", "links.b4", "links.b7", "links.b8"
    }  # fmt: skip


def test_nearest_imbalance_within_tight_bounds() -> None:
    result = balance(APPENDIX_4, TIGHT)
    assert result.after.joints.j7 == 1.5
    assert result.after.joints.j9 == 0.2
    assert 0 < result.seconds < 60  # not an instant of the clock
    nearest = static_imbalance(result.after)
    assert 0 < nearest < static_imbalance(APPENDIX_4)
    rng = np.random.default_rng(3)
    for j7, j9 in rng.uniform((0.1, 0.2), (1.5, 0.3), (200, 2)):
        assert static_imbalance(APPENDIX_4.vary({"joints.j7": j7, "joints.j9": j9})) >= nearest
    prices = [item.price for item in result.active]
    assert prices == sorted(prices, reverse=True)
    assert [(item.name, item.side) for item in result.active] == [
        ("joints.j9", "low"), ("joints.j7", "high")
    ]  # fmt: skip
    for item in result.active:
        step = {"low": -1e-3, "high": 1e-3}[item.side]
        other = result.after.vary({item.name: item.bound + step})
        assert nearest - static_imbalance(other) == pytest.approx(1e-3 * item.price)


def test_exact_balance_out_of_bounds_reports_relaxations() -> None:
    with pytest.raises(InfeasibleBounds) as caught:
        balance(APPENDIX_4, TIGHT, exact=True)
    (short,) = caught.value.limits
    nearest = balance(APPENDIX_4, TIGHT).after
    assert short.attainable == pytest.approx(static_imbalance(nearest))
    relax = {(item.name, item.side): item for item in caught.value.relax}
    # m_9 counts three times as much for a kg, so that it goes first, and down to nothing
    assert relax["joints.j9", "low"].needed == 0.0
    assert relax["joints.j7", "high"].bound == 1.5
    assert relax["joints.j7", "high"].needed == pytest.approx(3.063 - 3 * 0.259)
    assert "lower the lower bound of joints.j9 from 0.2 kg to 0 kg" in str(caught.value)
    assert "raise the upper bound of joints.j7 from 1.5 kg to 2.286 kg" in str(caught.value)
    # with the bounds moved so it is possible, and with a little less it is not
    for share, possible in ((1.0 + 1e-9, True), (0.99, False)):
        ranges = {"joints.j7": [0.1, 1.5], "joints.j9": [0.2, 0.3]}
        for item in caught.value.relax:
            side = 0 if item.side == "low" else 1
            ranges[item.name][side] += share * (item.needed - item.bound)
        wider = Changes(tuple(MassRange(path, max(a, 0.0), b) for path, (a, b) in ranges.items()))
        if possible:
            assert abs(static_imbalance(balance(APPENDIX_4, wider, exact=True).after)) < 1e-14
        else:
            with pytest.raises(InfeasibleBounds):
                balance(APPENDIX_4, wider, exact=True)


def test_no_relaxation_where_none_helps() -> None:
    """Every mass that may change pulls the same way, and all of them are gone already."""
    with pytest.raises(InfeasibleBounds, match="bounds 100 kg wider would not help") as caught:
        balance(APPENDIX_4, Changes((MassRange("joints.j9", 0.0, 1.0),)), exact=True)
    assert caught.value.relax == ()


def test_existing_counterweight_can_change() -> None:
    design = replace(APPENDIX_4, counterweights=(Counterweight("b8", 8, 0.1, 1.0),))
    result = balance(design, Changes((MassRange("counterweights.0.mass", 0.0, 10.0),)))
    (weight,) = result.after.counterweights
    assert weight.beyond == 0.1
    assert weight.mass == pytest.approx(9.10041 / 9.81 * 4.2, rel=1e-12)
    assert abs(static_imbalance(result.after)) < 1e-14


def test_a_balanced_design_stays_as_it_is() -> None:
    once = balance(APPENDIX_4).after
    again = balance(once)
    assert again.after == once
    assert again.objective == pytest.approx(0.0, abs=1e-12)


@given(design=samples.possible_designs(samples.LOADS))
def test_a_design_of_any_possible_masses_is_balanced_or_refused(design: Design) -> None:
    try:
        after = balance(design).after
    except (InvalidDesign, SolverFailed):  # a mass above its range; less than rounding is left
        return
    assert abs(static_imbalance(after)) <= abs(static_imbalance(design)) * (1 + 1e-9)
