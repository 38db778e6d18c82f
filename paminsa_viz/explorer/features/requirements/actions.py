"""Actions on the requirements of a document, each a pure function from state to state."""

from __future__ import annotations

import math
from dataclasses import replace
from enum import Enum
from typing import TYPE_CHECKING, Any

from paminsa_viz.explorer.core.actions import change_document
from paminsa_viz.explorer.core.place import Place
from paminsa_viz.explorer.core.requirements import default_workspace
from paminsa_viz.explorer.core.saved_requirements import MOST_REQUIREMENTS, require_possible
from paminsa_viz.explorer.features.requirements.suggestions import sampled, suggested
from paminsa_viz.explorer.kit.task import Task
from paminsa_viz.explorer.state.document import Document
from paminsa_viz.explorer.state.requirements import LargestJob, LargestOutcome
from paminsa_viz.explorer.state.state import State
from paminsa_viz.model import InvalidInput
from paminsa_viz.model.reach import home_pose
from paminsa_viz.model.resizing import length_ratio
from paminsa_viz.progress import Progress
from paminsa_viz.quantities import QUANTITIES
from paminsa_viz.quantities.requirements import (
    Range,
    Requirement,
    Workspace,
    WorkspaceShape,
)

if TYPE_CHECKING:
    from paminsa_viz.synthesis.proof.largest import LargestWorkspace

TURN = math.radians(30)
"""Half of the range of headings that is suggested [rad]."""

REACH_MARGIN = 0.01
"""Margin to the limits of reach that is suggested, if the design keeps it, at Appendix 4's lengths
[m]."""

OWN_HALF_HEIGHT = 0.1
"""Half of a requirement's own range of heights at first, at Appendix 4's lengths [m]."""


class Side(Enum):
    """What a requirement bounds; values are the labels."""

    MOST = "at most (≤)"
    LEAST = "at least (≥)"
    SIZE = "magnitude (|·| ≤)"
    BETWEEN = "between"


def side_of(requirement: Requirement) -> Side:
    """Return what a requirement bounds."""
    if requirement.low is None:
        return Side.MOST
    if requirement.high is None:
        return Side.LEAST
    return Side.SIZE if requirement.low == -requirement.high else Side.BETWEEN


def change(state: State, **changes: Any) -> State:
    """Change the requirements of the document.

    Raises:
        InvalidInput: If the page takes no such requirements.
    """
    requirements = replace(state.document.requirements, **changes)
    require_possible(requirements)
    return change_document(state, requirements=requirements)


def selected(state: State) -> Requirement | None:
    """Return the requirement that is edited, or None."""
    bounds, index = state.document.requirements.bounds, state.requirements.selected
    return bounds[index] if 0 <= index < len(bounds) else None


def select(state: State, index: int) -> State:
    """Edit another requirement."""
    return state.updated("requirements", selected=index)


def edit(state: State, **changes: Any) -> State:
    """Change attributes of the requirement that is edited.

    Raises:
        InvalidInput: If a bound or a range is not possible.
    """
    one = selected(state)
    if one is None:
        return state
    bounds = list(state.document.requirements.bounds)
    bounds[state.requirements.selected] = replace(one, **changes)
    return change(state, bounds=tuple(bounds))


SUGGESTED = ("condition", "max_torque", "f_4", "reach_margin")
"""Keys of the quantities that are suggested, in this order."""


def with_headings(state: State) -> State:
    """Return the state with headings to hold for, where there is only the one of home so far.

    What is proven for a single heading says nothing of a robot that turns.
    """
    requirements = state.document.requirements
    untouched = not requirements.bounds and requirements.workspace is None
    if untouched and requirements.theta == (0.0, 0.0):
        return change(state, theta=(-TURN, TURN))
    return state


def add(state: State, quantity: str | None = None) -> State:
    """Add a requirement, which is then edited; its bound is the current design's.

    Args:
        state: The state.
        quantity: Key of what is bounded; without it, a quantity that has no bound yet.

    Raises:
        InvalidInput: If there are too many.
    """
    state = with_headings(state)
    bounds = state.document.requirements.bounds
    if len(bounds) >= MOST_REQUIREMENTS:
        raise InvalidInput("requirements", f"at most {MOST_REQUIREMENTS} are possible here")
    if quantity is None:
        bounded = {bound.quantity for bound in bounds}
        free = (key for key in (*SUGGESTED, *QUANTITIES) if key not in bounded)
        quantity = next(free, SUGGESTED[0])
    added = change(state, bounds=(*bounds, suggested(state.document, quantity)))
    return select(added, len(bounds))


def remove(state: State) -> State:
    """Remove the requirement that is edited."""
    index = state.requirements.selected
    if selected(state) is None:
        return state
    bounds = state.document.requirements.bounds
    removed = change(state, bounds=(*bounds[:index], *bounds[index + 1 :]))
    return select(removed, max(0, min(index, len(bounds) - 2)))


def choose_quantity(state: State, quantity: str) -> State:
    """Bound another quantity, with the ranges as they are."""
    one = selected(state)
    if one is None or one.quantity == quantity:
        return state
    other = suggested(state.document, quantity)
    return edit(state, quantity=quantity, low=other.low, high=other.high)


def choose_side(state: State, side: Side) -> State:
    """Bound another side; the number stays as far as it can."""
    one = selected(state)
    if one is None or side is side_of(one):
        return state
    size = one.high if one.high is not None else one.low
    value = 0.0 if size is None else size
    match side:
        case Side.MOST:
            return edit(state, low=None, high=value)
        case Side.LEAST:
            return edit(state, low=value, high=None)
        case Side.SIZE:
            return edit(state, low=-abs(value), high=abs(value))
        case Side.BETWEEN:
            low, high = min(one.low or 0.0, value), max(value, 0.0)
            return edit(state, low=low, high=high if high != -low else high + max(abs(high), 1.0))


class End(Enum):
    """What a number of a requirement is; values are its name in messages from the page."""

    LOW = "low"
    HIGH = "high"
    SIZE = "size"


def ends_of(requirement: Requirement) -> dict[End, float]:
    """Return the numbers of a requirement in the order in which they are written [SI]."""
    low, high = requirement.low, requirement.high
    if side_of(requirement) is Side.SIZE and high is not None:
        return {End.SIZE: high}
    return {
        end: value for end, value in ((End.LOW, low), (End.HIGH, high)) if value is not None
    }  # fmt: skip


def set_bound(state: State, index: int, end: End, shown: float) -> State:
    """Set a number of a requirement.

    Args:
        state: The state.
        index: Which requirement; nothing happens if there is none.
        end: Which of its numbers; nothing happens if it has none such.
        shown: The number, in the unit in which the quantity is shown.

    Raises:
        InvalidInput: If the bound is not possible.
    """
    bounds = list(state.document.requirements.bounds)
    if not 0 <= index < len(bounds) or end not in ends_of(bounds[index]):
        return state
    one = bounds[index]
    value = one.entry.display.to_si(shown)
    if end is End.SIZE and value < 0:
        raise InvalidInput(one.entry.symbol, f"a magnitude is not negative ({shown:g})")
    ends = {"low": -value, "high": value} if end is End.SIZE else {end.value: value}
    bounds[index] = replace(one, **ends)
    return change(state, bounds=tuple(bounds))


def set_own_range(state: State, name: str, on: bool) -> State:
    """Give the requirement that is edited a range of headings or heights of its own, or none."""
    own: Range | None = None
    if on and name == "theta":
        own = state.document.requirements.theta
    elif on:
        geometry = state.document.design.geometry
        z, half = home_pose(geometry)[3], OWN_HALF_HEIGHT * length_ratio(geometry)
        digits = max(3, 1 - math.floor(math.log10(half)))  # a millimeter, less of small robots
        own = (round(z - half, digits), round(z + half, digits))
    return edit(state, **{name: own})


def suggest(state: State) -> State:
    """Ask for what the current design can do around home: condition, torque, force and reach.

    Raises:
        InvalidInput: If it reaches nothing of the workspace.
    """
    state = with_headings(state)
    workspace = state.document.requirements.workspace or default_workspace(state.document)
    state = change(state, workspace=workspace)
    design, theta = state.document.design, state.document.requirements.theta
    reach = QUANTITIES["reach_margin"]
    if not (sampled(design, theta, workspace, [reach])[reach.key] >= 0).any():
        raise InvalidInput("design", "it reaches nothing of the workspace; change its lengths")
    bounds = [suggested(state.document, key) for key in SUGGESTED]
    margin = max(bounds[-1].low or 0.0, 0.0)
    usual = float(f"{REACH_MARGIN * length_ratio(state.document.design.geometry):.2g}")
    bounds[-1] = replace(bounds[-1], low=min(margin, usual))
    return select(change(state, bounds=tuple(bounds)), 0)


def set_workspace(state: State, **changes: Any) -> State:
    """Change the required workspace.

    Raises:
        InvalidInput: If it is not possible.
    """
    workspace = state.document.requirements.workspace
    if workspace is None:
        return state
    return change(state, workspace=replace(workspace, **changes))


def choose_shape(state: State, shape: WorkspaceShape | None) -> State:
    """Require a workspace of another shape, of the same size as far as it goes; None for none."""
    held = state.document.requirements.workspace
    if shape is None:
        return change(state, workspace=None)
    state = with_headings(state)
    if held is None:
        held = default_workspace(state.document)
    size = shape.section.fitted(held.size)
    return change(state, workspace=replace(held, shape=shape, size=size))


def proportions(document: Document, shape: WorkspaceShape, free: bool) -> Workspace:
    """Return the workspace that gives the proportions and, unless it is free, the center."""
    held = document.requirements.workspace or default_workspace(document)
    center: Any = (None, None, None) if free else held.center
    return Workspace(shape, shape.section.fitted(held.size), center)


def largest_job(state: State) -> LargestJob:
    """Return the search for the largest workspace that is proven.

    Raises:
        InvalidInput: If nothing is required.
    """
    document, asked = state.document, state.requirements.largest.settings
    if not document.requirements.bounds:
        raise InvalidInput("requirements", "add one first: nothing but reach bounds the workspace")
    return LargestJob(
        document.design, replace(document.requirements, workspace=None),
        proportions(document, asked.shape, asked.free), asked.growth, asked.seconds,
    )  # fmt: skip


def find_largest(job: LargestJob, progress: Progress) -> LargestWorkspace:
    """Find the largest workspace."""
    from paminsa_viz.synthesis.proof.largest import largest_workspace
    from paminsa_viz.synthesis.proof.regions import Growth

    return largest_workspace(
        job.design, job.requirements, job.workspace, growth=Growth[job.growth],
        time_limit=job.seconds, progress=progress,
    )  # fmt: skip


def _largest_again(state: State, outcome: LargestOutcome) -> LargestJob:
    """Return the search anew; a workspace that was found and is required by now is no other one."""
    proven, required = state.requirements.largest.proven, state.document.requirements.workspace
    job = largest_job(state)
    used = proven is not None and required == Workspace(*proven)
    return replace(job, workspace=outcome.job.workspace) if used else job


LARGEST = Task(
    Place(lambda state: state.requirements.largest), largest_job, find_largest,
    again=_largest_again, bodies=True,
)  # fmt: skip
"""Searches for the largest workspace that is proven."""


def use_largest(state: State) -> State:
    """Require the workspace that was found.

    Raises:
        InvalidInput: If none was proven.
    """
    proven = state.requirements.largest.proven
    if proven is None:
        raise InvalidInput("workspace", "none is proven")
    return change(state, workspace=Workspace(*proven))
