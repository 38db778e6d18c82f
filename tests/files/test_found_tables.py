"""Tables of what was identified and calibrated, and of motions that excite; archives of files."""

from __future__ import annotations

import io
import zipfile
from dataclasses import replace
from io import StringIO

import numpy as np
import pytest

from paminsa_viz.actuation import actuator_limits
from paminsa_viz.files.archives import zipped
from paminsa_viz.files.identification_table import (
    estimate_table,
    excitation_table,
    residual_table,
)
from paminsa_viz.files.measurements import lengths_table
from paminsa_viz.files.measurements import residual_table as calibration_residuals
from paminsa_viz.files.tables import table_csv
from paminsa_viz.files.trajectory_table import parse_trajectory
from paminsa_viz.identification import (
    ExcitationLimits,
    ExcitationSettings,
    IdentificationSettings,
    identify,
    nearest_masses,
    optimize_excitation,
)
from paminsa_viz.identification.causes import Causes
from paminsa_viz.identification.findings import Findings
from paminsa_viz.model import APPENDIX_4
from paminsa_viz.model.accuracy import LEG_NAMES
from paminsa_viz.precision.calibration import calibrate
from paminsa_viz.precision.leg_lengths import LENGTHS, deviation_array
from tests.precision.test_calibration import measure, random_deviations
from tests.support.identification_logs import simulated


@pytest.fixture(scope="module")
def findings() -> Findings:
    """Of a short log, of which one number is not excited at all."""
    log = simulated(1, APPENDIX_4, rate=200.0, duration=8.0)
    found = identify(APPENDIX_4, log, IdentificationSettings(robustness=False, legs=True))
    first, *others = found.estimates
    found = replace(found, estimates=(replace(first, half_width=np.inf, known=False), *others))
    return Findings(found, nearest_masses(found), Causes((), (), ()))


def test_estimates_have_their_intervals_and_what_is_not_known_has_none(findings: Findings) -> None:
    found = findings.identification
    table = estimate_table(findings)
    rows = list(zip(*(column.tolist() for column in table.columns.values()), strict=True))
    assert list(table.columns)[:4] == ["symbol", "unit", "value", "half_width_95"]
    for row, item in zip(rows, found.estimates, strict=True):
        half = item.half_width if np.isfinite(item.half_width) else np.nan
        own = (item.symbol, item.parameter.unit, item.value, half, item.parameter.design)
        np.testing.assert_equal(row, (*own, "yes" if item.known else "no"))
    assert np.isnan(table.columns["half_width_95"]).any()
    assert table.provenance["log"] == found.log.name
    assert float(table.provenance["cut-off [Hz]"]) == found.settings.cut_off
    assert table.provenance["note 1"] == found.notes[0]


def test_residuals_are_of_every_actuator_over_time(findings: Findings) -> None:
    found, table = findings.identification, residual_table(findings)
    np.testing.assert_array_equal(table.columns["t_s"], found.signals.t)
    for j, name in enumerate(("tau1_Nm", "tau2_Nm", "tau3_Nm", "f4_N")):
        np.testing.assert_array_equal(table.columns[f"measured_{name}"], found.measured[:, j])
        np.testing.assert_array_equal(table.columns[f"predicted_{name}"], found.predicted[:, j])


def test_an_excitation_is_a_trajectory_that_states_its_limits() -> None:
    own = actuator_limits(APPENDIX_4)
    limits = ExcitationLimits(own.speed, own.rated)
    settings = ExcitationSettings(period=8.0, evaluations=0, random=4, seed=3)
    found = optimize_excitation(APPENDIX_4, limits, settings)
    table = excitation_table(APPENDIX_4, found, 50.0)
    motion = parse_trajectory(StringIO(table_csv(table).decode(), newline=""), "motion.csv")
    np.testing.assert_allclose(motion.pose, found.plan.sample(50.0).pose)
    head = table.provenance
    assert (float(head["period [s]"]), head["harmonics"], head["seed"]) == (8.0, "5", "3")
    assert float(head["log det of the information"]) == pytest.approx(found.log_det, abs=0.01)
    best = head[f"log det of the best of {found.random}"]
    assert float(best) == pytest.approx(found.random_log_det, abs=0.01)
    for row in found.limits:
        value, bound = head[f"{row.name} [{row.unit}]" if row.unit else row.name].split(", ")
        assert float(value) == pytest.approx(row.value, rel=1e-5)
        words, _, limit = bound.rpartition(" ")
        assert words == ("at least" if row.least else "at most")
        assert float(limit) == pytest.approx(row.limit, rel=1e-5)


@pytest.mark.slow
@pytest.mark.parametrize("width", [4, 6])
def test_calibrated_lengths_and_what_is_left_of_each_pose(width: int) -> None:
    data = measure(APPENDIX_4, random_deviations(1), 24, width, 1e-5)
    found = calibrate(APPENDIX_4, data, validate=0.25)
    lengths, left = (
        lengths_table(found, "poses.csv"),
        calibration_residuals(found, data, "poses.csv"),
    )
    names = [f"{leg}.{length.name}" for leg in LEG_NAMES for length in LENGTHS]
    assert lengths.columns["length"].tolist() == names
    assert lengths.columns["unit"].tolist() == [length.unit for length in LENGTHS] * 3
    np.testing.assert_array_equal(
        lengths.columns["deviation"].reshape(3, 14), deviation_array(found.design)
    )
    known = lengths.columns["known"] == "yes"
    np.testing.assert_array_equal(known, found.determined.ravel())
    assert known.any() == (width == 6)
    assert not known.all()
    np.testing.assert_array_equal(np.isnan(lengths.columns["standard_deviation"]), ~known)
    coordinates = ("x_m", "y_m", "theta_rad", "z_m", "tiltx_rad", "tilty_rad")[:width]
    for j, name in enumerate(coordinates):
        np.testing.assert_array_equal(left.columns[name], data.poses[:, j])
        np.testing.assert_array_equal(left.columns[f"before_{name}"], found.residuals_before[:, j])
        np.testing.assert_array_equal(left.columns[f"after_{name}"], found.residuals_after[:, j])
    np.testing.assert_array_equal(left.columns["held_back"] == "yes", found.held)
    for table in (lengths, left):
        assert table.provenance["measured poses"] == "poses.csv"
        assert table.provenance["held back"] == str(found.held.sum()) == "6"
        assert table.provenance["combinations fitted"] == str(len(found.combinations))
        assert float(table.provenance["noise [m]"]) == pytest.approx(found.noise, rel=1e-5)


def test_equal_files_give_equal_archives_in_a_folder_or_none() -> None:
    files = {"a.txt": b"one" * 1000, "sub/b.bin": bytes(range(256))}
    for folder in ("", "kit"):
        content = zipped(files, folder)
        assert content == zipped(dict(files), folder)
        with zipfile.ZipFile(io.BytesIO(content)) as archive:
            assert archive.testzip() is None
            found = {info.filename: archive.read(info) for info in archive.infolist()}
            assert all(info.external_attr >> 16 == 0o644 for info in archive.infolist())
            assert archive.getinfo(next(iter(found))).compress_size < 1000
        assert found == {f"{folder}/{name}".lstrip("/"): text for name, text in files.items()}
