"""The section Calibrate: poses to measure, measured poses, what they tell, and its use."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from paminsa_viz.blocks.calibration import calibration_blocks
from paminsa_viz.explorer.core import actions as poses
from paminsa_viz.explorer.core.frame import compute
from paminsa_viz.explorer.features.calibration import actions, files, texts
from paminsa_viz.explorer.features.calibration import tab as panel
from paminsa_viz.explorer.features.calibration.charts import residual_figure
from paminsa_viz.explorer.kit.entries import given
from paminsa_viz.explorer.state.calibration import EXAMPLE_SIZE, MeasuredPoses
from paminsa_viz.explorer.state.state import State, initial_state
from paminsa_viz.files.design_file import read_content
from paminsa_viz.files.measurements import parse_measurements
from paminsa_viz.files.table_reader import uploaded_table
from paminsa_viz.model import APPENDIX_4, InvalidInput
from paminsa_viz.precision.leg_lengths import deviation_array
from paminsa_viz.quantities.requirements import Requirement, Requirements
from tests.support.samples import enlarged
from tests.support.tables import assert_parts
from tests.support.tasks import finished


@pytest.fixture(scope="module")
def proposed() -> State:
    start = initial_state().updated("calibration.settings", poses=24)
    return finished(actions.PROPOSE, actions.PROPOSE.start(start))


@pytest.fixture(scope="module")
def calibrated(proposed: State) -> State:
    return finished(actions.CALIBRATE, actions.use_example(proposed))


def test_proposed_poses_are_written_as_the_table_that_is_read_again(proposed: State) -> None:
    _, plan = actions.PROPOSE.required(proposed, "", "")
    table = files.poses_csv(proposed)
    again = parse_measurements(uploaded_table(table.name, table.content), table.name)
    np.testing.assert_allclose(again.measurements.poses, plan.measurements.poses, rtol=1e-12)
    np.testing.assert_allclose(again.measurements.actuators, plan.measurements.actuators)
    assert len(again.measurements) == 24
    assert "combinations of lengths would be known" in texts.proposal_status_html(compute(proposed))
    assert texts.poses_html(compute(proposed)).count("<tr>") == 1 + 24


@pytest.mark.slow
def test_example_of_a_small_robot_is_as_small() -> None:
    """Legs off by half a millimeter would be another robot than one of some millimeters."""
    start = initial_state(enlarged(APPENDIX_4, 0.01)).updated("calibration.settings", poses=24)
    state = finished(actions.PROPOSE, actions.PROPOSE.start(start))
    assert "would be known to 0.01 mm" in texts.proposal_status_html(compute(state))
    state = finished(actions.CALIBRATE, actions.use_example(state))
    measured = state.calibration.measured
    assert measured is not None
    assert "up to 0.005 mm and 0.005 mrad, measured within 0.2 µm" in measured.about
    assert "predicted better than before" in texts.status_html(compute(state))


@pytest.mark.slow
def test_calibration_predicts_held_back_poses_of_the_example(calibrated: State) -> None:
    _, found = actions.CALIBRATE.required(calibrated, "", "")
    assert found.held.sum() >= 4
    assert np.linalg.norm(found.after_held.rms[:2]) < 0.1 * np.linalg.norm(
        found.before_held.rms[:2]
    )
    status = texts.status_html(compute(calibrated))
    assert "Held-back poses are predicted better than before" in status
    assert calibrated.calibration.measured is not None
    open_now = texts.measured_html(compute(calibrated))
    assert "computed, not measured" in open_now
    assert "not kept over a reload" in open_now
    blocks = calibration_blocks(found, None)
    for text in (texts.errors_html, texts.lengths_html, texts.combinations_html):
        assert_parts(text(compute(calibrated)), blocks)
    # they are not yet the design's
    assert "“Use as design” takes them into the design" in texts.lengths_html(compute(calibrated))
    figure = residual_figure(found)
    points = sum(len(trace["x"]) for trace in figure["data"])
    assert points == 4 * len(found.held)  # position and heading, before and after


@pytest.mark.slow
def test_lengths_become_the_designs_own_and_its_files(calibrated: State) -> None:
    used = actions.use_design(calibrated)
    design = used.document.design
    assert design.name == "Calibrated from example"
    _, found = actions.CALIBRATE.required(calibrated, "", "")
    np.testing.assert_array_equal(deviation_array(design), deviation_array(found.design))
    assert np.abs(deviation_array(design)).max() < 4 * EXAMPLE_SIZE
    assert not actions.CALIBRATE.is_stale(used), "the design is what was found"
    needed = Requirements((Requirement("condition", high=8.0),))
    for requirements, kept in ((Requirements(), None), (needed, needed)):
        asking = calibrated.updated("document", requirements=requirements)
        written = read_content(files.design_toml(asking).content, "d.toml")
        assert (written.design, written.requirements) == (design, kept)
    for kind, rows in (("lengths", 42), ("residuals", len(found.held))):
        lines = files.calibration_csv(calibrated, kind).content.decode().splitlines()
        assert sum(not line.startswith("#") for line in lines) == 1 + rows
    assert set(given(panel._use_choices, calibrated)) == {"Use as design", "Design TOML"}


@pytest.mark.slow
def test_lengths_of_another_design_are_refused(calibrated: State) -> None:
    other = poses.vary(calibrated, {"geometry.base_radius": 0.36})
    assert actions.CALIBRATE.is_stale(other)
    with pytest.raises(InvalidInput, match="calibrate again"):
        actions.use_design(other)
    with pytest.raises(InvalidInput, match="open some first"):
        actions.CALIBRATE.start(actions.close_measured(calibrated))


def test_too_few_poses_are_refused_in_a_line(proposed: State) -> None:
    measured = actions.PROPOSE.required(proposed, "", "")[1].measurements
    few = replace(measured, poses=measured.poses[:5], actuators=measured.actuators[:5])
    state = finished(actions.CALIBRATE, actions.use_measured(proposed, MeasuredPoses("few", few)))
    assert "at least 8 poses are needed" in texts.status_html(compute(state))
