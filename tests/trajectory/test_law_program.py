"""The program of a law against the robot itself: what its rows say of a law is what the law takes.

The states that a law makes on a path go through inverse dynamics and the definition of a drive.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from scipy import sparse
from scipy.optimize import linprog

from paminsa_viz.model import (
    APPENDIX_4,
    Design,
    actuator_acceleration,
    actuator_velocity,
    inverse_dynamics,
    static_torques,
)
from paminsa_viz.model.drive import NO_DRIVES, Drive
from paminsa_viz.trajectory import (
    MotionLimits,
    chain,
    circle,
    point_to_point,
    shortest_stretch,
    via_points,
)
from paminsa_viz.trajectory.law_program import LawProgram, Terms, _strictest
from paminsa_viz.trajectory.paths import TracedPath
from paminsa_viz.trajectory.shortest import law_knots
from tests.trajectory.plans import FRICTION, A, B, C
from tests.trajectory.test_timing import BENT, HEAVY, SERVO, VISCOUS, driven

UNIT = 0.7
"""Time in which the programs count [s]."""

LIMITS = MotionLimits(
    speed=1.1, turn_speed=5.0, acceleration=7.0, turn_acceleration=40.0, torque=6.0, force=430.0
)
PATH = TracedPath(via_points([A, B, A + np.array([0.03, 0.05, -0.2, 0.04]), B]).curve)
KNOTS = law_knots(PATH)


CORNER = 0.8 * B + 0.2 * A
STOPPING = TracedPath(chain(point_to_point(B, CORNER), point_to_point(CORNER, C)).curve)
"""A motion with a stop at about a fourth of its way, before which the pieces are longer."""


def law(s: Any, quick: float = 1.0) -> tuple[Any, Any]:
    """A law with zero speed at both ends, and its derivative by s, in units of `UNIT`."""
    bend = 1.0 + 0.8 * np.sin(9.0 * s)
    shape = 4.0 * s * (1.0 - s)
    slope = 4.0 * (1.0 - 2.0 * s) * bend + shape * 7.2 * np.cos(9.0 * s)
    return 2.0 * quick * shape * bend, 2.0 * quick * slope


def program(design: Design, limits: MotionLimits = LIMITS, **options: bool) -> LawProgram:
    return LawProgram(PATH, *KNOTS, limits, design, UNIT, **options)


def states(s: Any, path: TracedPath = PATH, quick: float = 1.0) -> tuple[Any, Any, Any]:
    """Pose, velocity and acceleration of the law at places, (n, 4) each."""
    z, dz = (part[:, None] for part in law(s, quick))
    along, bend = path(s, 1), path(s, 2)
    return path(s), along * np.sqrt(z) / UNIT, (bend * z + 0.5 * along * dz) / UNIT**2


def summed(terms: Terms, s: Any, quick: float = 1.0) -> Any:
    z, dz = (part[:, None] for part in law(s, quick))
    return terms.growth * dz + terms.square * z + terms.rate * np.sqrt(z) + terms.constant


def motor_share(
    design: Design,
    j: int,
    drive: Drive,
    s: Any,
    stop: bool = False,
    path: TracedPath = PATH,
    quick: float = 1.0,
) -> Any:
    """Largest share of a drive's speed, envelope and gear that the law uses, (n,).

    Beside a stop the motor has to make that at rest as well, of which the gear takes nothing.
    """
    pose, velocity, acceleration = states(s, path, quick)
    speed = actuator_velocity(design, pose, velocity)[:, j]
    growth = actuator_acceleration(design.geometry, pose, velocity, acceleration)[:, j]
    bare = replace(design, drives=NO_DRIVES)
    load = inverse_dynamics(bare, pose, velocity, acceleration).torque[:, j]
    eta, n = drive.total_efficiency, drive.ratio
    own = n * (drive.inertia * growth + drive.viscous * speed) + drive.coulomb * np.sign(speed)
    torques = [np.where(load * speed > 0, load / eta, load * eta) / n + own]
    if stop:
        torques.append(load / n + own)
    shares = [(speed / drive.output_limits.speed) ** 2]
    shares += [
        (np.abs(torque) + k * n * np.abs(speed)) / a for a, k in drive.lines for torque in torques
    ]
    if np.isfinite(drive.gear_limits.peak):
        shares.append(np.abs(load) / drive.gear_limits.peak)
    return np.max(shares, axis=0)


S = np.linspace(0.02, 0.98, 45)


@pytest.mark.parametrize("design", [APPENDIX_4, APPENDIX_4.vary(VISCOUS)], ids=["", "viscous"])
def test_terms_are_shares_of_what_the_robot_takes(design: Design) -> None:
    found = summed(program(design)._terms(S, *law(S)), S)
    pose, velocity, acceleration = states(S)
    torque = inverse_dynamics(design, pose, velocity, acceleration).torque
    shares = torque / [6.0, 6.0, 6.0, 430.0]
    turning = acceleration[:, 2] / 40.0
    expected = [
        (velocity[:, [0, 1, 3]] ** 2).sum(axis=1) / 1.1**2, (velocity[:, 2] / 5.0) ** 2,
        turning, -turning, *(sign * share for share in shares.T for sign in (1.0, -1.0)),
    ]  # fmt: skip
    np.testing.assert_allclose(found, np.transpose(expected), rtol=1e-9, atol=1e-11)


@pytest.mark.parametrize("alone", ["speed", "turn_speed", "turn_acceleration", "force"])
def test_a_limit_that_is_not_given_has_no_terms(alone: str) -> None:
    found = program(APPENDIX_4, MotionLimits(**{alone: getattr(LIMITS, alone)}))
    every = summed(program(APPENDIX_4)._terms(S, *law(S)), S)
    mine = summed(found._terms(S, *law(S)), S)
    assert mine.shape[1] == (2 if alone in ("turn_acceleration", "force") else 1)
    for column in mine.T:
        assert np.abs(every - column[:, None]).max(axis=0).min() < 1e-12


@pytest.mark.parametrize(("quick", "viscous"), [(0.01, 5.0), (1.0, 0.0), (25.0, 5.0)])
@pytest.mark.parametrize(
    "drive",
    [SERVO, HEAVY, BENT, replace(SERVO, efficiency=1.0, gear_peak_torque=3.0)],
    ids=["servo", "heavy", "bent", "gear"],
)
def test_terms_of_drives_are_shares_of_their_envelopes(
    drive: Drive, viscous: float, quick: float
) -> None:
    """At each place the largest of them is what the drive that needs most of its limits uses.

    Of laws that are slow, so that friction counts more than inertia, and of quick ones.
    """
    design = driven(drive).vary({"friction.viscous_rotary": viscous})
    none = MotionLimits(speed=1e9)
    found = summed(program(design, none)._terms(S, *law(S, quick)), S, quick).max(axis=1)
    expected = [
        motor_share(design, j, one, S, quick=quick) for j, one in enumerate(design.drives) if one
    ]
    np.testing.assert_allclose(found, np.max(expected, axis=0), rtol=1e-9)
    for j, one in enumerate(design.drives):
        assert one is not None
        places: Any = [one if i == j else None for i in range(4)]
        alone = replace(design, drives=tuple(places))
        mine = summed(program(alone, none)._terms(S, *law(S, quick)), S, quick).max(axis=1)
        np.testing.assert_allclose(mine, motor_share(alone, j, one, S, quick=quick), rtol=1e-9)
    assert program(design, none, drives=False)._terms(S, *law(S)).rate.shape[1] == 1
    level = TracedPath(circle(C, 0.05).curve)  # where M4 stands still
    made = LawProgram(level, *law_knots(level), none, design, UNIT)
    assert all(np.isfinite(part).all() for part in made._terms(S, *law(S)))


@pytest.mark.slow
@pytest.mark.parametrize("design", [APPENDIX_4, driven(SERVO)], ids=["", "driven"])
def test_rows_are_the_terms_at_the_law_before_and_no_less_strict_elsewhere(
    design: Design, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Rows on (z's coefficients, c, d), with c = 1 where z is that of the law before."""
    every = "paminsa_viz.trajectory.law_program._strictest"
    monkeypatch.setattr(every, lambda right, *left: np.arange(right.size))
    made = program(design)
    s = made.points
    rows, splines = made._rows(s)
    # any law that the spline has, near the one that rows are made at
    rng = np.random.default_rng(0)
    coefficients = np.abs(rng.normal(2.0, 0.3, rows.shape[1]))
    z, dz = rows @ coefficients, splines @ coefficients

    def before(places: Any) -> tuple[Any, Any]:
        assert places is s
        return z, dz

    matrix, right = made._limit_rows(before, rows, splines)
    timed = matrix.shape[1] - len(coefficients) - len(s)
    terms = made._terms(s, z, dz)

    def exceeded(law_z: Any, law_dz: Any, x: Any) -> tuple[Any, Any]:
        """By the rows, and by the terms that they stand for; one limit after the other."""
        c = np.sqrt(law_z / z)
        left = matrix @ np.concatenate([x, c, np.zeros(timed)]) - right
        sums = (
            terms.growth * law_dz[:, None] + terms.square * law_z[:, None]
            + terms.rate * np.sqrt(law_z)[:, None] + terms.constant - 1.0
        )  # fmt: skip
        # those with friction that fades come after them
        return left[: sums.size].reshape(-1, len(s)).T, sums

    by_rows, by_terms = exceeded(z, dz, coefficients)
    np.testing.assert_allclose(by_rows, by_terms, atol=1e-9 * np.abs(by_terms).max())
    other = coefficients * rng.uniform(0.3, 2.0, len(coefficients))
    by_rows, by_terms = exceeded(rows @ other, splines @ other, other)
    assert (by_rows >= by_terms - 1e-9 * np.abs(by_terms).max()).all()
    eased = terms.rate <= 0.0
    np.testing.assert_allclose(by_rows[eased], by_terms[eased], rtol=1e-7, atol=1e-7)


def test_of_rows_with_the_same_left_side_the_strictest_one_counts() -> None:
    """At each of three places; and one that nothing is multiplied in, if it leaves no room."""
    right = np.array([[3.0, 1.0, 1.0], [2.0, 2.0, 2.0], [2.0, 1.0, 0.5], [5.0, -1.0, 0.0]])
    one = np.array([[1.0, 1.0, 1.0], [1.0, 1.0, 1.0], [1.0, 2.0, 1.0], [0.0, 0.0, 0.0]])
    other = np.array([[4.0, 4.0, 4.0], [4.0, 4.0, 5.0], [6.0, 4.0, 4.0], [0.0, 0.0, 0.0]])
    kept = np.unravel_index(_strictest(right, one, other), right.shape)
    expected = {(1, 0), (2, 0), (0, 1), (2, 1), (3, 1), (1, 2), (2, 2)}
    assert set(zip(*(each.tolist() for each in kept), strict=True)) == expected


def test_cones_are_the_length_of_the_acceleration() -> None:
    made = program(APPENDIX_4)
    s = made.points
    rows, slopes = made._rows(s)
    coefficients = np.random.default_rng(1).uniform(0.5, 3.0, rows.shape[1])
    z, dz = (rows @ coefficients)[:, None], (slopes @ coefficients)[:, None]
    acceleration = (PATH(s, 2) * z + 0.5 * PATH(s, 1) * dz) / UNIT**2
    ((cone, right),) = made._cones(rows, slopes, 5)
    top, *parts = (right - cone @ np.concatenate([coefficients, np.ones(5)])).reshape(-1, 4).T
    np.testing.assert_allclose(top, 1.0)
    np.testing.assert_allclose(
        np.linalg.norm(parts, axis=0),
        np.linalg.norm(acceleration[:, [0, 1, 3]], axis=1) / 7.0, rtol=1e-9,
    )  # fmt: skip
    assert program(APPENDIX_4, MotionLimits(speed=1.0))._cones(rows, slopes, 5) == []
    assert sparse.issparse(cone)


def test_splines_of_the_program_rest_at_the_ends_and_have_their_own_slopes() -> None:
    made = program(APPENDIX_4)
    h = 1e-6
    s = np.linspace(0.013, 0.987, 60)
    rows, slopes = made._rows(s)
    ahead, behind = made._rows(s + h)[0], made._rows(s - h)[0]
    np.testing.assert_allclose(
        slopes.toarray(), ((ahead - behind) / (2.0 * h)).toarray(), atol=1e-4 * np.abs(slopes).max()
    )
    ones = np.ones(rows.shape[1])
    np.testing.assert_allclose(made._rows(np.array([0.0, 1.0]))[0] @ ones, 0.0)
    np.testing.assert_allclose(made._rows(np.array([0.3, 0.5]))[0] @ ones, 1.0)
    stopping = LawProgram(STOPPING, *law_knots(STOPPING), LIMITS, APPENDIX_4, UNIT)
    stops, moving = (
        stopping._rows(s)[0] for s in (STOPPING.place(STOPPING.rests), np.array([0.1, 0.6]))
    )
    np.testing.assert_allclose(stops @ np.ones(stops.shape[1]), 0.0, atol=1e-12)
    np.testing.assert_allclose(moving @ np.ones(stops.shape[1]), 1.0)


@pytest.mark.parametrize("path", [PATH, STOPPING], ids=["one piece", "stops"])
def test_beside_a_stop_a_motor_rests_as_well_and_elsewhere_it_drives_or_is_driven(
    path: TracedPath,
) -> None:
    design = driven(SERVO)
    made = LawProgram(path, *law_knots(path), MotionLimits(speed=1e9), design, UNIT)
    drives: Any = design.drives
    stops = path.place(path.rests)
    near = made.points[np.abs(made.points[:, None] - stops).min(axis=1) < 1e-7]
    assert len(near) == 2 * len(stops) - 2
    differs = 0
    for s, stop in ((near, True), (np.array([3e-5, 1.0 - 3e-5]), False)):
        found = summed(made._terms(s, *law(s)), s).max(axis=1)
        expected, other = (
            np.max(
                [motor_share(design, j, drive, s, how, path) for j, drive in enumerate(drives)],
                axis=0,
            )
            for how in (stop, not stop)
        )
        np.testing.assert_allclose(found, expected, rtol=1e-6)
        differs += int((np.abs(expected / other - 1.0) > 0.01).sum())
    assert differs > 1


def test_a_motion_down_may_end_where_its_motor_holds_but_cannot_lift() -> None:
    """The motion's own law, which keeps the limits, is one that the program knows."""
    hold = static_torques(APPENDIX_4, C)[3]
    weak = Drive(
        gear_ratio=1.0, efficiency=0.6, transmission="screw", lead=0.01,
        peak_torque=hold * 0.01 / (2 * np.pi) / 0.8,
    )  # fmt: skip
    down = point_to_point(C, C - [0.0, 0.0, 0.0, 0.05])
    design = replace(APPENDIX_4, drives=(None, None, None, weak))
    own = shortest_stretch(down, MotionLimits(acceleration=0.5), design).plan
    path = TracedPath(own.curve)
    made = LawProgram(path, *law_knots(path), MotionLimits(), design, own.duration)
    z, dz = (part[:, None] for part in path.law(made.points))
    terms = made._terms(made.points, z[:, 0], dz[:, 0])
    used = terms.growth * dz + terms.square * z + terms.rate * np.sqrt(z) + terms.constant
    assert 0.7 < used.max() <= 1.0 + 1e-6


def test_time_is_counted_exactly_for_cubics_of_a_piece() -> None:
    """At Gauss's two places of each; the ends of each are looked at from inside."""
    made = program(APPENDIX_4)
    knots, weights = KNOTS[0], made._weights
    nodes = made.points[: len(weights)]
    sides = made.points[len(weights) :].reshape(2, -1)
    assert len(weights) == 2 * (len(knots) - 1)
    for power in range(5):
        exact = (knots[1:] ** (power + 1) - knots[:-1] ** (power + 1)) / (power + 1)
        found = (weights * nodes**power).reshape(-1, 2).sum(axis=1)
        assert (np.abs(found - exact) <= 1e-15).all() == (power < 4)
    steps = np.diff(knots)
    np.testing.assert_allclose(sides[0] - knots[:-1], 1e-6 * steps, rtol=1e-6)
    np.testing.assert_allclose(knots[1:] - sides[1], 1e-6 * steps, rtol=1e-6)


@pytest.mark.parametrize(
    ("design", "limits"),
    [
        (APPENDIX_4, LIMITS), (APPENDIX_4.vary(FRICTION), MotionLimits(torque=8.0, force=450.0)),
        (driven(SERVO), MotionLimits(speed=0.9, acceleration=6.0)),
        (driven(HEAVY), MotionLimits(speed=50.0)),
    ],
    ids=["rates", "friction", "servo", "heavy"],
)  # fmt: skip
def test_what_the_solver_finds_keeps_its_limits_and_no_small_change_is_faster(
    design: Design, limits: MotionLimits
) -> None:
    """By a linear program of the terms' own slopes, within a hundredth of each coefficient."""
    knots = np.unique(np.concatenate([0.5 * (1 - np.cos(np.linspace(0, np.pi, 13))), *[
        PATH.place(PATH.breaks)[1:-1]]]))  # fmt: skip
    bends = np.isin(knots, [0.0, 1.0, *PATH.place(PATH.breaks)])
    made = LawProgram(PATH, knots, bends, limits, design, UNIT)
    s = made.points

    def before(places: Any) -> tuple[Any, Any]:
        return tuple(0.02 * part for part in PATH.law(places))  # type: ignore[return-value]

    x = made.solve(before).c[made._free]
    rows, slopes = (part.toarray() for part in made._rows(s))
    z, dz = rows @ x, slopes @ x
    tangent = np.sqrt(before(s)[0])[:, None]
    uses, changes = [], []
    # the limits hold with all of Coulomb friction, and with what the law before has of it
    for faded in (False, True):
        terms = made._terms(s, *before(s), faded=faded)
        above = np.maximum(terms.rate, 0.0)  # in place of a root: its tangent at the law before
        square = terms.square + above / (2 * tangent)
        constant = terms.constant + 0.5 * above * tangent
        rate = np.minimum(terms.rate, 0.0)
        sums = terms.growth * dz[:, None] + square * z[:, None] + rate * np.sqrt(z)[:, None]
        slope = (
            terms.growth[..., None] * slopes[:, None]
            + (square + 0.5 * rate / np.sqrt(z)[:, None])[..., None] * rows[:, None]
        )
        uses.append((sums + constant).ravel())
        changes.append(slope.reshape(-1, len(x)))
    used, change = np.concatenate(uses), np.concatenate(changes)
    most = limits.rates[1, 0] * UNIT**2
    if np.isfinite(most):
        along, bent = (PATH(s, order)[:, [0, 1, 3]] / most for order in (1, 2))
        by_axis = 0.5 * along[..., None] * slopes[:, None] + bent[..., None] * rows[:, None]
        size = np.linalg.norm(by_axis @ x, axis=1)
        used = np.append(used, size)
        toward = np.einsum("na,nam->nm", (by_axis @ x) / size[:, None], by_axis)
        change = np.concatenate([change, toward])
    assert used.max() <= 1.0 + 1e-6
    assert (np.sort(used)[-10:] > 1.0 - 1e-4).all()
    nodes, weights = z[: len(made._weights)], made._weights
    gain = (weights * nodes**-1.5) @ rows[: len(weights)] / 2.0
    best = linprog(
        -gain, change, np.maximum(1.0 - used, 0.0), method="highs",
        bounds=[(-0.01 * one, 0.01 * one) for one in x],
    )  # fmt: skip
    assert -best.fun < 1e-5 * (weights / np.sqrt(nodes)).sum()
