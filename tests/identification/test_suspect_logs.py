"""Logs that say nothing of a robot or something wrong: they are refused, or a note says so."""

from __future__ import annotations

import re
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from paminsa_viz.errors import PaminsaError
from paminsa_viz.files.example_designs import ExampleDesign, example_design
from paminsa_viz.identification import (
    IdentificationSettings,
    InvalidLog,
    base_parameters,
    base_regressor,
    identify,
    make_log,
)
from paminsa_viz.identification.causes import find_causes
from paminsa_viz.identification.estimate import RESOLUTION, normal_blocks
from paminsa_viz.identification.filtering import Signals
from paminsa_viz.identification.identify import _outliers, filtered, require_motion
from paminsa_viz.identification.log_poses import log_poses
from paminsa_viz.model import APPENDIX_4
from tests.support.identification_logs import RUBBING, multi_sine, simulated

QUICK = IdentificationSettings(robustness=False)


@pytest.mark.slow
def test_short_logs_and_torques_with_the_wrong_sign_are_noted() -> None:
    log = simulated(1, RUBBING, rate=200.0)
    short = identify(
        APPENDIX_4, make_log(log.t[:1200], log.position[:1200], log.torque[:1200]), QUICK
    )
    assert any("the log is 6 s long; 20 s or more are advised" in note for note in short.notes)
    for count, advised in ((3959, True), (3960, False), (len(log.t), False)):  # 19.8 s
        cut = make_log(log.t[:count], log.position[:count], log.torque[:count])
        assert any("advised" in note for note in identify(APPENDIX_4, cut, QUICK).notes) == advised
    first = identify(APPENDIX_4, log, QUICK).notes[0]
    assert "half at 10 Hz" in first
    assert "38 blocks of 0.5 s" in first  # 19.1 s are left after filtering


def test_a_note_says_where_an_outlier_widens_the_intervals() -> None:
    """The motion excites all that it leaves unknown: no advice on motions would help."""
    log = simulated(1, RUBBING, rate=60.0)
    assert not any("outlier" in note for note in identify(APPENDIX_4, log, QUICK).notes)
    torque = log.torque.copy()
    torque[round(8.2 * log.rate), 1] += 40.0
    found = identify(APPENDIX_4, make_log(log.t, log.position, torque), QUICK)
    (note,) = (note for note in found.notes if "outlier" in note)
    said = re.match(r"from (\S+) s to (\S+) s the torque of M2 is off by (\S+) times as", note)
    assert said is not None
    assert float(said[1]) < 8.2 < float(said[2]) <= float(said[1]) + 0.5
    left = [
        np.sqrt((found.residual[found.numbers == block, 1] ** 2).mean())
        for block in range(found.solution.blocks)
    ]
    assert float(said[3]) == pytest.approx(max(left) / np.median(left), rel=0.05)


@pytest.mark.parametrize(
    ("most", "spread", "noted"),
    [(10.2, 0.1, True), (9.8, 0.1, False), (20.0, 1980.0, True), (20.0, 2020.0, False)],
    ids=["beyond", "within", "large enough", "of a log without noise"],
)
def test_an_outlier_is_ten_times_what_is_left_elsewhere_and_a_hundredth_of_the_torque(
    most: float, spread: float, noted: bool
) -> None:
    numbers = np.repeat(np.arange(5), 4)
    left = np.ones((20, 4))
    left[8:12, 2] = most
    blocks = normal_blocks(np.zeros((20, 4, 1)), left, numbers)
    torque = spread * np.tile([[1.0], [-1.0]], (10, 4))
    signals = SimpleNamespace(t=np.arange(20.0), torque=torque)
    found = _outliers(signals, blocks, SimpleNamespace(x=np.zeros(1)), numbers)  # type: ignore[arg-type]
    assert [note.partition(" is off")[0] for note in found] == [
        "from 8 s to 11 s the torque of M3"
    ] * noted


def test_a_log_without_a_long_enough_piece_or_whose_legs_do_not_meet_is_refused() -> None:
    log = simulated(1, RUBBING, rate=200.0)
    kept = np.concatenate([np.arange(start, start + 180) for start in range(0, 3600, 200)])
    pieces = make_log(log.t[kept], log.position[kept], log.torque[kept], split=True)
    needed = r"log cut: a piece without gaps of at least .* s is needed; the longest is 0.895 s"
    with pytest.raises(InvalidLog, match=needed):  # of 180 rows
        identify(APPENDIX_4, replace(pieces, name="cut"), QUICK)
    apart = log.position.copy()
    apart[:, :3] = [0.0, 2.0, 4.5]
    with pytest.raises(InvalidLog, match=r"row 1: no pose of the platform fits"):
        identify(APPENDIX_4, make_log(log.t, apart, log.torque), QUICK)
    with pytest.raises(InvalidLog, match=r"no .* s in a row can be used: no pose"):
        identify(APPENDIX_4, make_log(log.t, apart, log.torque, split=True), QUICK)
    with pytest.raises(InvalidLog, match="a log needs at least 10 rows; there are 9"):
        make_log(log.t[:9], log.position[:9], log.torque[:9])
    with pytest.raises(PaminsaError, match=r"position: shape \(3999, 4\) where \(4000, 4\) is"):
        make_log(log.t, log.position[1:], log.torque)


def test_logs_with_wrong_torques_are_refused_or_noted() -> None:
    log = simulated(1, RUBBING, rate=200.0)
    stuck = log.torque.copy()
    stuck[:, 1] = 3.0
    with pytest.raises(InvalidLog, match="log stuck: the torque of M2 never changes"):
        identify(APPENDIX_4, replace(make_log(log.t, log.position, stuck), name="stuck"))
    # a light robot, whose joints 9 are pulled up by more than M_p2, has a weight all the same
    pulled = log.torque - 2.0 * base_parameters(RUBBING)[1] * base_regressor(
        RUBBING.geometry, *multi_sine(1, RUBBING)(log.t)
    )[..., 1]  # fmt: skip
    for torque, wrong in ((-log.torque, True), (1e-3 * pulled, False)):
        found = identify(APPENDIX_4, make_log(log.t, log.position, torque), QUICK)
        assert any("sign of force4" in note for note in found.notes) == wrong
        assert (found.estimates[0].high < 0) == wrong
        assert found.estimates[0].high < 1
        assert found.estimates[1].high < 0


@pytest.mark.slow
def test_torques_in_wrong_columns_or_of_opposite_signs_are_named() -> None:
    log = simulated(1, RUBBING, rate=200.0)
    for order, place in (((1, 0, 2, 3), "M2, M1, M3"), ((1, 2, 0, 3), "M3, M1, M2")):
        found = identify(APPENDIX_4, make_log(log.t, log.position, log.torque[:, order]), QUICK)
        assert f"seem to stand in the columns of {place}" in found.problem
        assert found.problem in found.notes
    opposite = make_log(log.t, log.position, log.torque * [-1.0, -1.0, -1.0, 1.0])
    assert "opposite to those that go with force4" in identify(APPENDIX_4, opposite, QUICK).problem
    assert not identify(APPENDIX_4, log, QUICK).problem


@pytest.mark.slow
def test_torques_of_another_unit_are_suspected_and_robots_of_another_weight_are_not() -> None:
    log = simulated(1, RUBBING, rate=200.0)
    for factor, suspected in ((1e-3, True), (0.01, True), (0.1, False), (1.0, False), (10.0, False),
                              (100.0, True), (1e3, True)):  # fmt: skip
        scaled = make_log(log.t, log.position, factor * log.torque)
        found = identify(APPENDIX_4, scaled, QUICK)
        assert ("N·m" in found.problem) == suspected, factor
        assert (f"about {factor:g} times" in found.problem) == suspected, factor
        assert (found.problem in found.notes) == suspected, factor
    for factor in (1e-3, 0.01, 100.0, 1e3):  # of M1 to M3 alone
        scaled = make_log(log.t, log.position, log.torque * [factor, factor, factor, 1.0])
        found = identify(APPENDIX_4, scaled, QUICK)
        assert f"about {factor:g} times" in found.problem, factor
        assert found.problem in found.notes, factor
        assert find_causes(found).named == (), factor
    # a weight where the design is balanced is no other unit, nor is noise
    noise = np.random.default_rng(0).standard_normal(log.torque.shape) * log.torque.std(axis=0)
    for torque in (log.torque, log.torque + 3 * noise):
        found = identify(
            example_design(ExampleDesign.BALANCED), make_log(log.t, log.position, torque), QUICK
        )
        assert not found.problem


def test_a_torque_that_changes_less_than_sensors_resolve_never_changes() -> None:
    """Measured by the largest torque or force of the log, not by its own."""
    log = simulated(1, RUBBING, rate=200.0)
    signals = filtered(log, APPENDIX_4, QUICK, log_poses(APPENDIX_4.geometry, log))
    least = RESOLUTION * np.abs(signals.torque).max()
    for share, moves in ((0.99, False), (1.01, True)):
        for sign in (1.0, -1.0):  # the largest may be negative
            torque = sign * signals.torque
            torque[:, 1] = np.linspace(0.0, share * least, len(torque))
            changed = replace(signals, torque=torque)
            if moves:
                require_motion(changed)
            else:
                with pytest.raises(InvalidLog, match="torque of M2 never changes"):
                    require_motion(changed)
    with pytest.raises(InvalidLog, match="torque of M1 never changes"):
        require_motion(replace(signals, torque=0.0 * signals.torque))


def test_a_log_needs_a_turn_of_a_hundredth_or_a_lift_of_a_millimeter() -> None:
    log = simulated(1, RUBBING, rate=200.0)
    signals = filtered(log, APPENDIX_4, QUICK, log_poses(APPENDIX_4.geometry, log))
    part = np.linspace(0.0, 1.0, len(signals.samples.position))[:, None]

    def moving(*travel: float) -> Signals:
        return replace(signals, samples=signals.samples._replace(position=part * travel))

    for enough in ((0.0, 0.01, 0.0, 0.0), (0.0101, 0.0, 0.0, 9e-4), (0.0, 0.0, 0.0, 1e-3)):
        require_motion(moving(*enough))
    for little in ((0.0099, 0.0099, 0.0099, 9.9e-4), (0.0, 0.0, 0.0, 0.0)):
        with pytest.raises(InvalidLog, match="hardly moves"):
            require_motion(moving(*little))
