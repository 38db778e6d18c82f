"""Everything that logs of a robot say, put together: what command line, page and report show."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from paminsa_viz.errors import InvalidDesign
from paminsa_viz.identification.causes import Causes, find_causes
from paminsa_viz.identification.columns import IdentificationSettings
from paminsa_viz.identification.identify import identify
from paminsa_viz.identification.log import InvalidLog, Log
from paminsa_viz.identification.nearest import NearestMasses, nearest_masses
from paminsa_viz.identification.results import Identification
from paminsa_viz.identification.validation import (
    PayloadEstimate,
    Validation,
    validate,
    weigh_payload,
)
from paminsa_viz.model.design import Design
from paminsa_viz.progress import Progress, go_on, keep_on
from paminsa_viz.trajectory.sampled import Trajectory

STEPS = ("fit", "masses", "causes", "second log", "payload")
"""What is worked out, in this order."""


@dataclass(frozen=True, eq=False)
class Findings:
    """What logs of a robot say.

    Attributes:
        identification: Of the first log.
        nearest: The design nearest to the robot's that explains it.
        causes: What may be wrong with the model.
        validation: How the numbers predict a second log, if there is one.
        payload: The payload of a third one, if there is one.
    """

    identification: Identification
    nearest: NearestMasses
    causes: Causes
    validation: Validation | None = None
    payload: PayloadEstimate | None = None

    @property
    def motion(self) -> Trajectory:
        """The platform's motion in the first log, its first piece without gaps."""
        signals = self.identification.signals
        kept = signals.segment == 0
        t = signals.t[kept]
        return Trajectory(
            t - t[0], signals.pose[kept], signals.velocity[kept], signals.acceleration[kept],
            self.identification.log.name, "measured",
        )  # fmt: skip


def investigate(
    log: Log,
    design: Design,
    settings: IdentificationSettings | None = None,
    *,
    other: Log | None = None,
    loaded: Log | None = None,
    payload: float | None = None,
    start: ArrayLike | None = None,
    progress: Progress = go_on,
) -> Findings:
    """Return everything that logs of a robot say.

    Args:
        log: The first log.
        design: The robot as it was meant.
        settings: What is fitted, and how.
        other: A log of another motion, to validate with.
        loaded: A log with a payload on the platform.
        payload: That payload, if it was weighed [kg].
        start: Pose (4,) near the start of all logs, to choose the assembly.
        progress: Called before each of `STEPS` with that ``step``; true ends the work.

    Raises:
        InvalidLog: At the first row of a log that cannot be used, if no design could have its
            numbers, or if the other log is the first.
        InvalidInput: If a setting or the payload is not possible.
        Canceled: If ``progress`` says so.
    """
    if other is not None and np.array_equal(other.position, log.position):
        problem = "it has the positions of the first log and proves nothing; take another motion"
        raise InvalidLog(problem, log=other.name)

    def done(step: str) -> None:
        keep_on(progress, STEPS.index(step) / len(STEPS), step=step)

    done("fit")
    found = identify(design, log, settings, start=start)
    done("masses")
    try:
        nearest = nearest_masses(found)
    except InvalidDesign as error:
        problem = f"no robot has its numbers ({error}); check the units and gains of its torques"
        raise InvalidLog(problem, log=log.name) from error
    done("causes")
    causes = find_causes(found)
    done("second log")
    validation = None if other is None else validate(found, other)
    done("payload")
    estimate = None if loaded is None else weigh_payload(found, loaded, known=payload)
    return Findings(found, nearest, causes, validation, estimate)
