"""What each misprint of the paper does, and that correcting all of them is what it takes.

The move: 1 s along a quintic, over 0.225 m with a peak acceleration of 1.3 m/s^2 and turned by
0.6 rad, by the robot of Appendix 4 in the paper's knee. Its dynamic part (what the torques are
above holding the weight) is up to 0.84, 2.36 and 1.75 N m on M1..M3 and 9.8 N on M4.

The misprints of Appendix 1 (indices) and Appendix 4 (kg/m^2) are looked at in `test_appendix_1` and
`test_lumped`; "l_C8" of Appendix 4 can only be l_B8, for there is no link C, and 8-9-4-7 is a
parallelogram for l_B8 = l_B3 (`test_kinematics`).
"""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
import pytest

from paminsa_viz.model import (
    APPENDIX_4,
    Design,
    KneeBranch,
    Misprint,
    inverse_dynamics,
    kinetic_energy,
    static_torques,
)
from paminsa_viz.trajectory import PRESET, analyze
from tests import oracle
from tests.support.cases import BOTH, PROTOTYPES
from tests.support.samples import with_knee

START = np.array([-0.09, -0.045, -0.3, -0.62])
END = np.array([0.09, 0.045, 0.3, -0.52])
TABLE = (
    Misprint.EQ13_LIFT_SPEED,
    Misprint.EQ13_LEG_SPIN,
    Misprint.APP3_MC4,
    Misprint.EQ14_PHI_SPEED,
    Misprint.EQ14_SINE_SIGNS,
)
"""In the order in which they stand in the paper."""


def quintic(n: int = 201) -> tuple[Any, Any, Any]:
    """Poses, velocities and accelerations of the move, each (n, 4)."""
    t = np.linspace(0.0, 1.0, n)[:, None]
    step = END - START
    s = 10 * t**3 - 15 * t**4 + 6 * t**5
    rate = 30 * t**2 - 60 * t**3 + 30 * t**4
    second = 60 * t - 180 * t**2 + 120 * t**3
    return START + s * step, rate * step, second * step


STATES = quintic()

REMAINING = {
    # left over on tau_1..3 [N m] and F_4 [N] after correcting this one and those before it
    None: (0.0917, 0.1879, 0.3911, 0.4385),
    Misprint.EQ13_LIFT_SPEED: (0.0917, 0.1879, 0.3911, 0.3761),
    Misprint.EQ13_LEG_SPIN: (0.0487, 0.2720, 0.2014, 0.3761),
    Misprint.APP3_MC4: (0.0510, 0.2709, 0.2001, 0.3742),
    Misprint.EQ14_PHI_SPEED: (0.0223, 0.0526, 0.0246, 0.0768),
    Misprint.EQ14_SINE_SIGNS: (0.0, 0.0, 0.0, 0.0),
}
ALONE = {
    # what one misprint does if everything else is right
    Misprint.EQ13_LIFT_SPEED: (0.0, 0.0, 0.0, 0.1762),
    Misprint.EQ13_LEG_SPIN: (0.0885, 0.0848, 0.2089, 0.0),
    Misprint.APP3_MC4: (0.0023, 0.0058, 0.0036, 0.0043),
    Misprint.EQ14_PHI_SPEED: (0.0412, 0.2323, 0.1776, 0.4503),
    Misprint.EQ14_SINE_SIGNS: (0.0223, 0.0526, 0.0246, 0.0768),
}
"""Measured once against the oracle, to four decimals; both tables in the paper's knee."""


@cache
def exact(knee: KneeBranch) -> Any:
    """The torques of the move from first principles, (n, 4)."""
    return oracle.inverse_dynamics(with_knee(APPENDIX_4, knee), *STATES)


def disagreement(misprints: Misprint, knee: KneeBranch = KneeBranch.LOWER) -> Any:
    """Largest error on each actuator during the move, (4,) [N m, N]."""
    torque = inverse_dynamics(with_knee(APPENDIX_4, knee), *STATES, misprints).torque
    return np.abs(torque - exact(knee)).max(axis=0)


def test_the_move_is_the_one_stated() -> None:
    translation = STATES[2][:, [0, 1, 3]]
    assert np.linalg.norm(translation, axis=-1).max() == pytest.approx(1.297, abs=1e-3)
    assert np.linalg.norm((END - START)[[0, 1, 3]]) == pytest.approx(0.2247, abs=1e-4)
    dynamic = exact(KneeBranch.LOWER) - oracle.static_torques(APPENDIX_4, STATES[0])
    np.testing.assert_allclose(np.abs(dynamic).max(axis=0), [0.836, 2.361, 1.749, 9.774], atol=1e-3)


def test_the_table_names_every_misprint_that_can_be_evaluated() -> None:
    assert set(TABLE) == set(Misprint)
    together = Misprint.NONE
    for misprint in TABLE:
        together |= misprint
    assert together == Misprint.ALL


def test_corrected_one_at_a_time_until_nothing_is_left() -> None:
    left = Misprint.ALL
    np.testing.assert_allclose(disagreement(left), REMAINING[None], atol=6e-5)
    for misprint in TABLE:
        left &= ~misprint
        np.testing.assert_allclose(disagreement(left), REMAINING[misprint], atol=6e-5)
    assert left == Misprint.NONE
    assert disagreement(left).max() < 1e-12


@pytest.mark.parametrize("misprint", TABLE, ids=str)
def test_each_alone(misprint: Misprint) -> None:
    np.testing.assert_allclose(disagreement(misprint), ALONE[misprint], atol=6e-5)


@BOTH
def test_only_without_any_misprint_is_the_model_right(knee: KneeBranch) -> None:
    """All 31 ways to leave some in."""
    for value in range(1, Misprint.ALL.value + 1):
        assert disagreement(Misprint(value), knee).max() > 1e-3
    assert disagreement(Misprint.NONE, knee).max() < 1e-12


def test_m_c4_and_eq_14_together_are_a_tenth_of_the_dynamic_torque() -> None:
    """0.272 of 2.361 N m on M2: 11.5 %."""
    three = Misprint.APP3_MC4 | Misprint.EQ14_PHI_SPEED | Misprint.EQ14_SINE_SIGNS
    error = disagreement(three)
    assert error[:3].max() == pytest.approx(0.2720, abs=6e-5)
    dynamic = exact(KneeBranch.LOWER) - static_torques(APPENDIX_4, STATES[0])
    share = error[1] / np.abs(dynamic[:, 1]).max()
    assert share == pytest.approx(0.115, abs=1e-3)


@PROTOTYPES
def test_misprints_do_not_affect_static_torques(design: Design) -> None:
    still = np.zeros(4)
    right = inverse_dynamics(design, STATES[0], still, still).torque
    for misprint in (*TABLE, Misprint.ALL):
        printed = inverse_dynamics(design, STATES[0], still, still, misprint).torque
        np.testing.assert_array_equal(printed, right)


def test_the_lift_speed_misprint_is_no_energy() -> None:
    """M_c6 Z' is linear: it changes sign with the motion and drops out of Lagrange's equations."""
    pose, v = STATES[0][100], np.array([0.0, 0.0, 0.0, 0.5])
    one, other = (
        kinetic_energy(APPENDIX_4, pose, s * v, misprints=Misprint.EQ13_LIFT_SPEED) for s in (1, -1)
    )
    assert one - other == pytest.approx(2 * 3 * APPENDIX_4.links.b1 / 8 * 0.5 / 3, rel=1e-12)


@pytest.mark.slow
@pytest.mark.parametrize(("preset", "percent"), [("paper-like", 11), ("circle", 21), ("arch", 31)])
def test_their_share_of_the_largest_torque_on_presets(preset: str, percent: int) -> None:
    motion = PRESET[preset].build(APPENDIX_4.geometry).sample()
    right = analyze(APPENDIX_4, motion).torque
    shares = [
        np.abs(analyze(APPENDIX_4, motion, misprints=misprints).torque - right).max(axis=0)
        / np.abs(right).max(axis=0)
        for misprints in (*TABLE, Misprint.ALL)
    ]
    assert round(100 * np.max(shares)) == percent
