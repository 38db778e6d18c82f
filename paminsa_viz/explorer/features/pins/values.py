"""What pinned numbers are at the pose: of the design, and of the reference."""

from __future__ import annotations

import math

import numpy as np

from paminsa_viz.explorer.core.frame import Frame
from paminsa_viz.explorer.state.pins import IMBALANCE, PinsJob, PinValue
from paminsa_viz.explorer.state.state import State
from paminsa_viz.model import PARAMETER, Design, Limit
from paminsa_viz.model.arrays import Pose
from paminsa_viz.model.grids import Field, Grid, solve_field
from paminsa_viz.model.statics import shown_imbalance
from paminsa_viz.progress import Progress
from paminsa_viz.quantities import QUANTITIES
from paminsa_viz.quantities.quantity import Quantity
from paminsa_viz.quantities.requirements import Requirement, Requirements

COSTLY = 1e-6
"""Time that a quantity takes [s] a pose in large numbers from which it waits for an idle page."""


def can_wait(state: State) -> bool:
    """Whether a pinned number is too costly to be found while something is dragged."""
    keys = state.pins.settings.keys
    return any(QUANTITIES[key].cost > COSTLY for key in keys if key in QUANTITIES)


def wanted(frame: Frame) -> PinsJob | None:
    """Return the job of what is shown; none while nothing is pinned."""
    state = frame.state
    keys, pose = state.pins.settings.keys, state.last_reachable.pose
    if not keys:
        return None
    required = state.document.requirements
    bounds = tuple(
        one for one in required.bounds if one.quantity in keys and _holds_at(one, required, pose)
    )
    return PinsJob(keys, frame.shown_design, state.document.reference, pose, bounds)


def _holds_at(bound: Requirement, required: Requirements, pose: Pose) -> bool:
    """Whether a requirement is one on a pose: its heading and height are among those it is on."""
    theta, z = required.headings(bound), bound.z
    return theta[0] <= pose[2] <= theta[1] and (z is None or z[0] <= pose[3] <= z[1])


def find_values(job: PinsJob, progress: Progress) -> tuple[PinValue, ...]:
    """Return the values of what is pinned."""
    own = _at(job.design, job)
    other = None if job.reference is None else _at(job.reference, job)
    found = []
    for done, key in enumerate(job.keys):
        if progress(done / len(job.keys)):
            break
        value, reason = _value(key, job.design, own)
        reference = math.nan
        if other is not None and job.reference is not None:
            reference, _ = _value(key, job.reference, other)
        bounds = [bound for bound in job.bounds if bound.quantity == key]
        margin, size = min(((float(one.margin(value)), one.size) for one in bounds),
                           default=(math.nan, 1.0))  # fmt: skip
        found.append(PinValue(value, reference, reason, margin, size))
    return tuple(found)


def _at(design: Design, job: PinsJob) -> Field:
    """Return what a design's geometry says about the pose alone."""
    return solve_field(design.geometry, Grid.over(job.pose, theta=[job.pose[2]]), threads=1)


def _value(key: str, design: Design, field: Field) -> tuple[float, str]:
    """Return a number [SI] and why there is none."""
    if key == IMBALANCE:
        return shown_imbalance(design), ""
    if key in PARAMETER:
        return design.value(key), ""
    quantity = QUANTITIES[key]
    value = float(quantity.over(field, design)[0])
    return value, _reason(quantity, field, design) if math.isnan(value) else ""


def _reason(quantity: Quantity, field: Field, design: Design) -> str:
    status = Limit(int(field.status[0]))
    if status is not Limit.OK:
        return status.explanation
    if quantity.missing is None:
        return "the pose is singular"
    missing = quantity.missing(field, design)
    return missing.texts[int(np.asarray(missing.code).flat[0])]
