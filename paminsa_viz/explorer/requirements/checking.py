"""Requirements of a session: which hold, and the volume with its surface."""

from __future__ import annotations

import time
from functools import lru_cache

from paminsa_viz.explorer.background import BackgroundJob, Report
from paminsa_viz.explorer.frame import Frame
from paminsa_viz.explorer.requirements.contradictions import conflict_text
from paminsa_viz.explorer.requirements.jobs import Placed, VolumeJob, VolumeOutcome
from paminsa_viz.explorer.requirements.saved import asked
from paminsa_viz.explorer.requirements.surface import surface_parts
from paminsa_viz.explorer.session import Session
from paminsa_viz.explorer.state import State
from paminsa_viz.model import Design, PaminsaError
from paminsa_viz.quantities.requirements import Requirements
from paminsa_viz.synthesis.volume.check import RequirementsCheck, check_requirements
from paminsa_viz.synthesis.volume.grid import COARSE, FINE
from paminsa_viz.synthesis.volume.margins import Canceled
from paminsa_viz.synthesis.volume.solve import solve_volume

CHEAP = 3e-6
"""Cost of all quantities [s a pose] up to which a given workspace is checked at once: some 5 ms."""

VOLUME_SHARE = 0.6
"""Part of a fine job that the volume takes; the check and the surface take the rest."""


@lru_cache(maxsize=4)
def _at_once(design: Design, requirements: Requirements) -> RequirementsCheck:
    return check_requirements(design, requirements)


def is_quick(requirements: Requirements) -> bool:
    """Whether requirements are checked so fast that nothing has to wait."""
    workspace = requirements.workspace
    cost = sum({bound.entry.formula: bound.entry.cost for bound in requirements.bounds}.values())
    return workspace is not None and None not in workspace.center and cost <= CHEAP


def current_check(state: State) -> RequirementsCheck | None:
    """Return which requirements hold, as finely as is known; None if nothing is known yet."""
    document = state.document
    if not asked(document.requirements):
        return None
    for outcome in (state.requiring.fine, state.requiring.quick):
        if outcome is not None and outcome.check is not None and outcome.job.serves(document):
            return outcome.check
    if is_quick(document.requirements):
        return _at_once(document.design, document.requirements)
    return None


def current_volume(state: State) -> VolumeOutcome | None:
    """Return the volume of the current design, the fine one if it is there."""
    for outcome in (state.requiring.fine, state.requiring.quick):
        if outcome is not None and outcome.job.serves(state.document):
            return outcome
    return None


def placed_workspace(state: State) -> Placed | None:
    """Return the required workspace where it is or, if it is free, where it fits best."""
    workspace = state.document.requirements.workspace
    if workspace is None:
        return None
    x, y, z = workspace.center
    if x is None or y is None or z is None:
        check = current_check(state)
        if check is None or check.center is None:
            return None
        x, y, z = check.center
    return workspace.shape, workspace.size, (x, y, z)


def find_volume(job: VolumeJob, report: Report) -> VolumeOutcome:
    """Find the volume and what holds; what is the robot's fault is no error."""
    start = time.monotonic()
    try:
        volume = solve_volume(
            job.design, job.requirements, resolution=FINE if job.fine else COARSE,
            progress=lambda done: report(VOLUME_SHARE * done),
        )  # fmt: skip
        check = check_requirements(
            job.design, job.requirements, fine=job.fine, volume=volume,
            progress=lambda done: report(VOLUME_SHARE + (1 - VOLUME_SHARE) * done),
        )  # fmt: skip
    except Canceled:
        return VolumeOutcome(job, problem="canceled")
    except PaminsaError as error:
        return VolumeOutcome(job, problem=str(error))
    surface = surface_parts(volume) if job.fine else ()
    workspace = None if volume.empty else job.requirements.workspace
    conflict = "" if check.holds else conflict_text(volume, workspace)
    return VolumeOutcome(job, volume, check, surface, conflict, time.monotonic() - start)


def receive(state: State, outcome: VolumeOutcome) -> State:
    """Take over a result, unless something else is required by now."""
    if not outcome.job.serves(state.document) or not asked(state.document.requirements):
        return state
    name = "fine" if outcome.job.fine else "quick"
    return state.updated("requiring", **{name: outcome})


class VolumeSolver:
    """Finds the volume of what is shown: coarse at once, fine when the page is idle."""

    def __init__(self, session: Session) -> None:
        self._jobs = {
            fine: BackgroundJob[VolumeJob, VolumeOutcome](
                session, f"requirements.{'fine' if fine else 'quick'}", find_volume, receive,
                failed=lambda job, problem: VolumeOutcome(job, problem=problem), undo=False,
            )
            for fine in (False, True)
        }  # fmt: skip
        self._wanted: dict[bool, VolumeJob | None] = {False: None, True: None}

    def draw(self, frame: Frame, dragging: bool) -> None:
        """Ask for what is not known yet."""
        state = frame.state
        if state.synthesizing.running is not None:  # it needs all cores, and shows other robots
            return
        document, known = state.document, state.requiring
        for fine, outcome in ((False, known.quick), (True, known.fine)):
            wanted = self._wanted[fine]
            if not asked(document.requirements):
                wanted = None
            elif wanted is None or not wanted.serves(document):
                there = outcome is not None and outcome.job.serves(document)
                waits = there or (fine and dragging)
                wanted = None if waits else VolumeJob(document.design, document.requirements, fine)
            self._wanted[fine] = wanted
            self._jobs[fine].request(wanted)
