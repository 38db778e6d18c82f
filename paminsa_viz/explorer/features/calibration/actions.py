"""What a person can ask of the calibration, each as a pure function from state to state."""

from __future__ import annotations

from dataclasses import replace

from paminsa_viz.errors import TableFileError, printable
from paminsa_viz.explorer.core.actions import with_design
from paminsa_viz.explorer.core.place import Place
from paminsa_viz.explorer.kit.task import Task
from paminsa_viz.explorer.state.calibration import (
    EXAMPLE_SIZE,
    CalibrateJob,
    CalibrationSettings,
    MeasuredPoses,
    ProposalJob,
)
from paminsa_viz.explorer.state.outcome import Outcome
from paminsa_viz.explorer.state.settings import at_first
from paminsa_viz.explorer.state.state import State
from paminsa_viz.files.design_writer import NAME_CHARACTERS
from paminsa_viz.model import Design, InvalidInput, PaminsaError
from paminsa_viz.model.resizing import length_ratio
from paminsa_viz.precision import (
    Calibration,
    CalibrationPlan,
    calibrate,
    plan_calibration,
    simulated_measurements,
    with_deviations,
)
from paminsa_viz.precision.leg_lengths import deviation_array, lengths_only
from paminsa_viz.precision.measurements import InvalidMeasurement
from paminsa_viz.progress import Canceled, Progress, go_on
from paminsa_viz.units import display_unit, number

EXAMPLE_POSES = 60
"""How many poses example measurements have if none are proposed."""


def propose_poses(job: ProposalJob, progress: Progress) -> CalibrationPlan:
    """Choose poses to measure.

    Raises:
        PaminsaError: If the robot has too few, or the work was stopped.
    """
    own = job.settings
    try:
        return plan_calibration(
            job.design, own.poses, coordinates=own.coordinates, noise=own.noise, seed=own.seed,
            progress=progress,
        )  # fmt: skip
    except Canceled:
        raise PaminsaError("it was stopped") from None


def calibrate_lengths(job: CalibrateJob, progress: Progress) -> Calibration:
    """Calibrate.

    Raises:
        PaminsaError: If the measured poses do not allow it, or the work was stopped.
    """
    own, measured = job.settings, job.measured
    try:
        return calibrate(
            job.design, measured.measurements, validate=own.held, seed=own.seed, progress=progress
        )
    except InvalidMeasurement as error:
        if not measured.first_row:
            raise
        row = measured.first_row + error.index
        raise TableFileError(measured.name, error.problem, row=row) from error
    except Canceled:
        raise PaminsaError("it was stopped") from None


def _proposal_job(state: State) -> ProposalJob:
    geometry = state.document.design.geometry
    return ProposalJob(Design(geometry=geometry), state.calibration.settings.of_proposal)


def _calibrate_job(state: State) -> CalibrateJob:
    own = state.calibration
    if own.measured is None:
        raise InvalidInput("measured poses", "open some first")
    return CalibrateJob(
        lengths_only(state.document.design), own.measured, own.settings.of_calibration
    )


def _calibrate_again(state: State, outcome: Outcome[CalibrateJob, Calibration]) -> CalibrateJob:
    """Return the job anew; a design that has the lengths it found by now is no other one."""
    job, found = _calibrate_job(state), outcome.result
    own = found is not None and job.design == found.design
    return replace(job, design=outcome.job.design) if own else job


PROPOSE = Task(
    Place(lambda state: state.calibration.proposal), _proposal_job, propose_poses,
)  # fmt: skip
"""Chooses poses to measure."""

CALIBRATE = Task(
    Place(lambda state: state.calibration), _calibrate_job, calibrate_lengths,
    again=_calibrate_again,
)  # fmt: skip
"""Identifies the legs' lengths from the measured poses that are open."""


def use_measured(state: State, measured: MeasuredPoses) -> State:
    """Take measured poses, and calibrate with them at once."""
    return CALIBRATE.start(state.updated("calibration", measured=measured))


def use_example(state: State) -> State:
    """Take measurements of a robot whose legs are off at random, in the proposed poses if any.

    Raises:
        PaminsaError: If such a robot cannot be measured.
    """
    own, design = state.calibration.settings, state.document.design
    plan = None if PROPOSE.is_stale(state) else PROPOSE.result(state)
    if plan is None:
        plan = propose_poses(
            replace(_proposal_job(state), settings=replace(own, poses=EXAMPLE_POSES)),
            go_on,
        )
    size = at_first(EXAMPLE_SIZE, 1, length_ratio(design.geometry), (0.0, EXAMPLE_SIZE))
    found = simulated_measurements(
        design, plan.measurements, size=size, noise=own.noise, seed=own.seed
    )
    return use_measured(state, MeasuredPoses("example", found, about=_example_text(own, size)))


def _example_text(own: CalibrationSettings, size: float) -> str:
    lengths = display_unit("m").format(size)
    noise = display_unit("m:um").format(own.noise)
    return (
        f"computed, not measured: this robot with legs off at random by up to {lengths} and "
        f"{number(1e3 * size)} mrad, measured within {noise}"
    )


def close_measured(state: State) -> State:
    """Close the measured poses and what came of them."""
    return CALIBRATE.forget(state.updated("calibration", measured=None))


def calibrated_design(state: State) -> Design:
    """Return the design with the lengths that were found, under a name that says so.

    Raises:
        InvalidInput: If there are none, or they are not of the design's lengths.
    """
    job, found = CALIBRATE.required(state, "measured poses", "nothing has been calibrated yet")
    design = state.document.design
    if design.geometry != found.start.geometry:
        raise InvalidInput(
            "lengths", "they have changed since the calibration; calibrate again, or undo"
        )
    name = f"Calibrated from {printable(job.measured.name)}"[:NAME_CHARACTERS]
    return replace(with_deviations(design, deviation_array(found.design)), name=name)


def use_design(state: State) -> State:
    """Make the lengths that were found the design's.

    Raises:
        InvalidInput: If there are none, or they are not of the design's lengths.
    """
    return with_design(state, calibrated_design(state))
