"""Identifies from logs, and finds motions for it."""

from __future__ import annotations

from typing import TYPE_CHECKING

from paminsa_viz.actuation import actuator_limits
from paminsa_viz.explorer.state.identification import ExcitationJob, IdentifyJob
from paminsa_viz.model import PaminsaError
from paminsa_viz.model.singular_limit import serial_clearance
from paminsa_viz.progress import Canceled, Progress

if TYPE_CHECKING:  # a page waits for none of it at its start
    from paminsa_viz.identification import Excitation
    from paminsa_viz.identification.findings import Findings


def identify_logs(job: IdentifyJob, progress: Progress) -> Findings:
    """Identify.

    Raises:
        PaminsaError: If a log does not allow it, or the work was stopped.
    """
    from paminsa_viz.identification import IdentificationSettings
    from paminsa_viz.identification.findings import investigate

    own = job.settings
    settings = IdentificationSettings(
        cut_off=own.cut_off, delay=own.delay, rotors=own.rotors, legs=own.legs,
        constrain=own.constrain,
    )  # fmt: skip
    try:
        return investigate(
            job.log, job.design, settings, other=job.other, loaded=job.loaded,
            payload=own.payload or None, progress=progress,
        )  # fmt: skip
    except Canceled:
        raise PaminsaError("it was stopped") from None


def search_excitation(job: ExcitationJob, progress: Progress) -> Excitation:
    """Search for a motion.

    Raises:
        PaminsaError: If the robot has none within its limits.
    """
    from paminsa_viz.identification import (
        ExcitationLimits,
        ExcitationSettings,
        optimize_excitation,
    )

    own, limits = job.settings, actuator_limits(job.design)
    settings = ExcitationSettings(
        period=own.period, harmonics=own.harmonics, periods=own.periods, seconds=own.seconds,
        evaluations=1_000_000,
    )  # fmt: skip
    clearance = serial_clearance(job.design.geometry)
    kept = ExcitationLimits(limits.speed, limits.rated, clearance=clearance)
    return optimize_excitation(job.design, kept, settings, progress=progress)
