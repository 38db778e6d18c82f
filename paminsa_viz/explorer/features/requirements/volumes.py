"""The volume where all requirements hold, coarse and fine: found whenever they have changed."""

from __future__ import annotations

from dataclasses import replace
from functools import partial

from paminsa_viz.blocks.requirements import conflict_notes
from paminsa_viz.explorer.core.causes import surface_parts
from paminsa_viz.explorer.core.frame import Frame
from paminsa_viz.explorer.core.place import Place
from paminsa_viz.explorer.core.saved_requirements import asked
from paminsa_viz.explorer.kit.task import Follower
from paminsa_viz.explorer.state.requirements import VolumeJob, VolumeOutcome, VolumeResult
from paminsa_viz.explorer.state.state import State
from paminsa_viz.model import PaminsaError
from paminsa_viz.progress import Canceled, Progress, of_part
from paminsa_viz.synthesis.volume.check import check_requirements
from paminsa_viz.synthesis.volume.conflict import smallest_conflict
from paminsa_viz.synthesis.volume.grid import COARSE, FINE
from paminsa_viz.synthesis.volume.solve import solve_volume

VOLUME_SHARE = 0.6
"""Part of a fine job that the volume takes; the check and the surface take the rest."""


def find_volume(job: VolumeJob, progress: Progress) -> VolumeResult:
    """Find the volume and what holds.

    Raises:
        PaminsaError: If the requirements cannot be checked, or the work was stopped.
    """
    try:
        volume = solve_volume(
            job.design, job.requirements, resolution=FINE if job.fine else COARSE,
            progress=of_part(progress, 0.0, VOLUME_SHARE),
        )  # fmt: skip
        check = check_requirements(
            job.design, job.requirements, fine=job.fine, volume=volume,
            progress=of_part(progress, VOLUME_SHARE, 1.0),
        )  # fmt: skip
    except Canceled:
        raise PaminsaError("canceled") from None
    surface = surface_parts(volume) if job.fine else ()
    asked_for = replace(job.requirements, workspace=None) if volume.empty else job.requirements
    conflict = None if check.holds else smallest_conflict(volume, asked_for.workspace)
    notes = [] if conflict is None else conflict_notes(asked_for, conflict)
    return VolumeResult(volume, check, surface, tuple(note.text for note in notes))


def receive(state: State, outcome: VolumeOutcome) -> State:
    """Take over a result, unless something else is required by now."""
    if not outcome.job.serves(state.document) or not asked(state.document.requirements):
        return state
    name = "fine" if outcome.job.fine else "quick"
    return state.updated("requirements", **{name: outcome})


def wanted_volume(frame: Frame, *, fine: bool) -> VolumeJob | None:
    """Return the job of what is shown; none while a search needs all cores, and shows others."""
    document, searching = frame.state.document, frame.state.synthesis.running is not None
    if searching or not asked(document.requirements):
        return None
    return VolumeJob(document.design, document.requirements, fine)


VOLUMES = (
    Follower(
        Place(lambda state: state.requirements.quick), partial(wanted_volume, fine=False),
        find_volume, receive=receive,
    ),
    Follower(
        Place(lambda state: state.requirements.fine), partial(wanted_volume, fine=True),
        find_volume, receive=receive, idle=True,
    ),
)  # fmt: skip
