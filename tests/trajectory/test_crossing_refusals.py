"""Motions through type-2 singularities that are refused: why, and what would be enough."""

from __future__ import annotations

import re

import numpy as np
import pytest
from scipy.optimize import brentq

from paminsa_viz.model import (
    APPENDIX_4,
    InvalidInput,
    check_reach,
    singular_radius,
    singular_rotation,
    static_torques,
)
from paminsa_viz.trajectory import MotionLimits
from paminsa_viz.trajectory.crossing import crossings
from paminsa_viz.trajectory.crossing_program import CrossingProgram
from paminsa_viz.trajectory.paths import straight_path
from paminsa_viz.trajectory.time_optimal import CrossingRefused, time_optimal
from tests.trajectory.crossings import (
    BALANCED,
    PLAIN,
    TEN,
    TURN,
    shortest,
)


@pytest.mark.parametrize("kind", ["acceleration", "turn_acceleration", "jerk", "turn_jerk"])
def test_limits_that_are_not_kept_across_a_locus_are_refused(kind: str) -> None:
    with pytest.raises(InvalidInput, match="torque or force, and at most speed and turn_speed"):
        time_optimal(BALANCED, TURN, MotionLimits(torque=10.0, **{kind: 100.0}))
    with pytest.raises(InvalidInput, match="torque or force, and at most"):
        time_optimal(BALANCED, TURN, MotionLimits(speed=1.0))


@pytest.mark.slow
def test_refusals_name_their_cause() -> None:
    geometry = APPENDIX_4.geometry
    turn = singular_rotation(geometry)
    radius = float(singular_radius(geometry, 0.3))
    meet = np.array([float(singular_radius(geometry, turn)), 0.0, turn, -0.5])  # both loci
    shift = np.array([0.05, 0.0, 0.1, 0.0])
    cases = {
        "rest": straight_path([0.0, 0.01, turn, -0.5], [0.0, 0.01, 0.3, -0.5]),
        "hold": straight_path([0.0, 0.01, turn - 1e-3, -0.5], [0.0, 0.01, 0.3, -0.5]),
        "tangent": straight_path([radius, -0.1, 0.3, -0.5], [radius, 0.1, 0.3, -0.5]),
        "reach": straight_path([0.0, 0.0, 0.3, -0.5], [2.0, 0.0, 0.3, -0.5]),
        "double": straight_path(meet - shift, meet + shift),
    }
    back = straight_path(cases["rest"].goal, cases["rest"].start)
    near = []  # a crossing a millionth of the path from either end is one of a rest
    for cause, share in (("rest", 0.95e-6), ("hold", 1.05e-6)):
        start = np.array([0.0, 0.01, turn + share * (turn - 0.3) / (1.0 - share), -0.5])
        ends = start, np.array([0.0, 0.01, 0.3, -0.5])
        near += [(cause, straight_path(*ends)), (cause, straight_path(*ends[::-1]))]
    for cause, path in (*cases.items(), ("rest", back), *near):
        with pytest.raises(CrossingRefused) as refusal:
            time_optimal(APPENDIX_4, path, MotionLimits(torque=5.0))
        assert refusal.value.cause == cause
        if cause == "reach":  # of 800 parts of the path the first that begins out of reach
            parts = 800 * refusal.value.s
            assert parts == pytest.approx(round(parts), abs=1e-9)
            at = np.array([refusal.value.s - 1.0 / 800, refusal.value.s])
            assert check_reach(geometry, path(at)).ok.tolist() == [True, False]
    far = brentq(lambda x: check_reach(geometry, [x, 0.0, 0.3, -0.5]).margins.min(), 0.3, 2.0)
    with pytest.raises(CrossingRefused, match=r"^at s = 1: ") as refusal:  # the goal alone
        time_optimal(
            APPENDIX_4, straight_path(cases["reach"].start, [far + 1e-6, 0.0, 0.3, -0.5]), TEN
        )
    assert (refusal.value.cause, refusal.value.s) == ("reach", 1.0)
    with pytest.raises(CrossingRefused, match=r"times as large") as refusal:
        time_optimal(APPENDIX_4, TURN, MotionLimits(torque=6.0))
    factor = float(str(refusal.value).split("at least ")[1].split(" times")[0])
    assert time_optimal(APPENDIX_4, TURN, MotionLimits(torque=6.0 * factor * 1.01)).crossings


@pytest.mark.slow
def test_an_end_that_cannot_be_held_names_its_actuator_and_what_it_needs() -> None:
    held = static_torques(APPENDIX_4, TURN(np.array([0.0, 1.0])))
    most = np.abs(held[:, :3]).max(axis=1)
    limit = 0.5 * min(most)
    heavier = APPENDIX_4.vary({"gravity": 9.82})  # 3.24218 N·m, which is more than 3.242
    back = straight_path(TURN.goal, TURN.start)
    for design, path in ((APPENDIX_4, TURN), (APPENDIX_4, back), (heavier, TURN)):
        torque = static_torques(design, path(np.array([0.0])))[0]
        worst = int(np.abs(torque[:3]).argmax())
        with pytest.raises(CrossingRefused, match="the start cannot be held") as refusal:
            time_optimal(design, path, MotionLimits(torque=limit))
        said = re.search(rf"M{worst + 1} needs (\S+) of {limit:.4g} N·m", str(refusal.value))
        assert said is not None
        assert 1.0 <= float(said[1]) / abs(torque[worst]) < 1.001  # no less than it takes
        assert (refusal.value.cause, refusal.value.s) == ("hold", 0.0)
    order = np.argsort(most)  # the easier end first: it is held, the other one is not
    ends = TURN(np.array([0.0, 1.0]))[order]
    with pytest.raises(CrossingRefused, match="the goal cannot be held") as refusal:
        time_optimal(APPENDIX_4, straight_path(*ends), MotionLimits(torque=float(np.mean(most))))
    assert (refusal.value.cause, refusal.value.s) == ("hold", 1.0)
    weak = MotionLimits(torque=100.0, force=0.5 * np.abs(held[:, 3]).min())
    with pytest.raises(CrossingRefused, match=r"M4 needs \S+ of \S+ N$"):
        time_optimal(APPENDIX_4, TURN, weak)
    with pytest.raises(CrossingRefused) as refusal:  # what holds both ends exactly, holds them
        time_optimal(APPENDIX_4, TURN, MotionLimits(torque=float(max(most))))
    assert refusal.value.cause == "infeasible"
    crossing = shortest(APPENDIX_4, TURN, TEN).crossings[0]
    assert f"crosses the singular rotation at {crossing.t:.4g} s;" in crossing.explanation


def test_a_refusal_says_what_torques_are_enough_while_speeds_stay_limited() -> None:
    def shortest_law(torque: float) -> np.ndarray:
        limits = MotionLimits(torque=torque, turn_speed=1.0)
        found = crossings(APPENDIX_4.geometry, TURN)
        return CrossingProgram(APPENDIX_4, TURN, found, limits, *PLAIN).fastest()

    with pytest.raises(CrossingRefused, match=r"times as large") as refusal:
        shortest_law(5.5)
    factor = float(str(refusal.value).split("at least ")[1].split(" times")[0])
    assert shortest_law(5.5 * factor).any()
    with pytest.raises(CrossingRefused, match=r"times as large"):
        shortest_law(5.5 * factor * 0.99)


def test_a_refusal_names_the_speed_limit_that_no_torque_makes_up_for() -> None:
    def shortest_law(turn_speed: float) -> np.ndarray:
        limits = MotionLimits(torque=1000.0, turn_speed=turn_speed)
        found = crossings(APPENDIX_4.geometry, TURN)
        return CrossingProgram(APPENDIX_4, TURN, found, limits, *PLAIN).fastest()

    with pytest.raises(CrossingRefused, match="speed limits would have to be") as refusal:
        shortest_law(0.1)
    factor = float(str(refusal.value).split("at least ")[1].split(" times")[0])
    assert shortest_law(0.1 * factor).any()
    with pytest.raises(CrossingRefused, match="speed limits would have to be"):
        shortest_law(0.1 * factor * 0.99)
