"""Requirements: a list of bounds with their margins, the required workspace, and the volume."""

from __future__ import annotations

from functools import partial
from operator import attrgetter
from typing import Any

from paminsa_viz.explorer.browser.bridge import finite
from paminsa_viz.explorer.core import actions as poses
from paminsa_viz.explorer.core.requirements import default_workspace
from paminsa_viz.explorer.core.saved_requirements import asked
from paminsa_viz.explorer.core.session import Session
from paminsa_viz.explorer.features.pins.tab import pin
from paminsa_viz.explorer.features.requirements import actions
from paminsa_viz.explorer.features.requirements import texts as text
from paminsa_viz.explorer.features.requirements.inputs import DEGREES, EDIT, has_selected
from paminsa_viz.explorer.features.requirements.largest import LARGEST_WORKSPACE
from paminsa_viz.explorer.features.requirements.volumes import VOLUMES
from paminsa_viz.explorer.kit.entries import (
    Answer,
    ButtonGroup,
    Condition,
    Effect,
    Folder,
    Html,
    Message,
)
from paminsa_viz.explorer.kit.inputs import Checkbox, Dropdown, Number, Pair, attribute
from paminsa_viz.explorer.state.settings import MILLIMETERS
from paminsa_viz.explorer.state.state import State
from paminsa_viz.quantities.requirements import Workspace, WorkspaceShape

SHAPES: dict[str, WorkspaceShape | None] = {
    "none": None, **{shape.value: shape for shape in WorkspaceShape}
}  # fmt: skip

NOWHERE = Workspace(WorkspaceShape.CYLINDER, (0.1, 0.1, 0.1), (0.0, 0.0, 0.0))
"""What hidden inputs show."""


def _buttons(state: State) -> dict[str, Effect]:
    found: dict[str, Effect] = {"Add": actions.add, "Suggested set": actions.suggest}
    chosen = actions.selected(state)
    if chosen is not None:
        found |= {"Remove": actions.remove, "Pin": partial(pin, key=chosen.quantity)}
    return found


def workspace(state: State) -> Workspace:
    """Return the required workspace, or one for inputs that are hidden."""
    return state.document.requirements.workspace or NOWHERE


def _shape_is(*shapes: WorkspaceShape) -> Condition:
    def holds(state: State) -> bool:
        held = state.document.requirements.workspace
        return held is not None and held.shape in shapes

    return holds


ANY_SHAPE = _shape_is(*WorkspaceShape)
CYLINDER, BOX = _shape_is(WorkspaceShape.CYLINDER), _shape_is(WorkspaceShape.BOX)

LARGEST, LEAST = 10.0, 0.001
"""Sizes of a workspace that can be typed [m]."""


def _set_size(state: State, **changes: float) -> State:
    """Change sizes of the required workspace, by the names of their coordinates [m]."""
    sizes = dict(zip("xyz", workspace(state).size, strict=True)) | changes
    return actions.set_workspace(state, size=tuple(sizes.values()))


def _set_center(state: State, *, level: bool, place: tuple[float | None, ...]) -> State:
    """Change x and y of the center, or z."""
    center = workspace(state).center
    changed = (*place, center[2]) if level else (*center[:2], *place)
    return actions.set_workspace(state, center=changed)


def _level_free(state: State) -> bool:
    return None in workspace(state).center[:2]


def _height_free(state: State) -> bool:
    return workspace(state).center[2] is None


WORKSPACE = (
    Pair(
        "requirements.headings", "θ [°]", units=(DEGREES, DEGREES), step=1.0, ordered=True,
        hint="Headings that count, from and to: every requirement without a range of its own has "
        "to hold for all of them",
        read=lambda state: state.document.requirements.theta,
        apply=lambda state, ends: actions.change(state, theta=ends),
    ),
    Dropdown(
        "requirements.shape", "Workspace", options=SHAPES,
        hint="What has to lie within the volume where all requirements hold",
        read=lambda state: (
            None if (w := state.document.requirements.workspace) is None else w.shape
        ),
        apply=actions.choose_shape,
    ),
    Pair(
        "requirements.cylinder", "r, height [mm]", visible=CYLINDER, hint="Radius, then height",
        units=(MILLIMETERS, MILLIMETERS), step=1.0, range=((LEAST, LARGEST), (LEAST, LARGEST)),
        read=lambda state: (workspace(state).size[1] / 2, workspace(state).size[2]),
        apply=lambda state, size: _set_size(state, x=2 * size[0], y=2 * size[0], z=size[1]),
    ),
    Pair(
        "requirements.box", "x, y size [mm]", visible=BOX, hint="Whole extents along x and y",
        units=(MILLIMETERS, MILLIMETERS), step=1.0, range=((LEAST, LARGEST), (LEAST, LARGEST)),
        read=lambda state: workspace(state).size[:2],
        apply=lambda state, size: _set_size(state, x=size[0], y=size[1]),
    ),
    Number(
        "requirements.height", "Height [mm]", visible=BOX, hint="Whole extent along z",
        unit=MILLIMETERS, step=1.0, range=(LEAST, LARGEST),
        read=lambda state: workspace(state).size[2],
        apply=lambda state, height: _set_size(state, z=height),
    ),
    Checkbox(
        "requirements.anywhere", "Free center x, y", visible=ANY_SHAPE, read=_level_free,
        hint="The center is found where the workspace fits best",
        apply=lambda state, free: _set_center(
            state, level=True, place=(None, None) if free else (0.0, 0.0)
        ),
    ),
    Pair(
        "requirements.center", "Center x, y [mm]", hint="From the robot’s axis",
        units=(MILLIMETERS, MILLIMETERS), step=1.0,
        visible=lambda state: ANY_SHAPE(state) and not _level_free(state),
        read=lambda state: tuple(place or 0.0 for place in workspace(state).center[:2]),
        apply=lambda state, place: _set_center(state, level=True, place=place),
    ),
    Checkbox(
        "requirements.any_height", "Free center z", visible=ANY_SHAPE, read=_height_free,
        hint="The height is found where the workspace fits best",
        apply=lambda state, free: _set_center(
            state, level=False,
            place=(None if free else default_workspace(state.document).center[2],),
        ),
    ),
    Number(
        "requirements.center_z", "Center z [mm]", unit=MILLIMETERS, step=1.0,
        hint="Half the height of the workspace is above it; 0 is the plane of the guides",
        visible=lambda state: ANY_SHAPE(state) and not _height_free(state),
        read=lambda state: workspace(state).center[2] or 0.0,
        apply=lambda state, place: _set_center(state, level=False, place=(place,)),
    ),
)  # fmt: skip


def _index(data: Any) -> int | None:
    """Return the index of a requirement that the page names, or None."""
    plain = isinstance(data, str) and data.isascii() and data.isdecimal() and len(data) < 4
    return int(data) if plain else None


def _select(session: Session, data: Any) -> None:
    """Edit the requirement that was clicked; ``data`` comes from the page."""
    index = _index(data)
    if index is not None:
        action = partial(actions.select, index=index)
        session.dispatch("requirements.selected", action, step=False)


def _set_bound(session: Session, data: Any) -> None:
    """Set a number in the table; ``data`` comes from the page: which of which row, and to what."""
    which, value = data if isinstance(data, list) and len(data) == 2 else ("", None)
    row, _, name = which.partition(" ") if isinstance(which, str) else ("", "", "")
    index, number = _index(row), finite(value)
    if index is None or number is None or name not in set(map(attrgetter("value"), actions.End)):
        return
    action = partial(actions.set_bound, index=index, end=actions.End(name), shown=number)
    session.dispatch(f"requirements.{which}", action)


def _go(session: Session, data: Any) -> None:
    """Go to a worst pose; ``data`` comes from the page."""
    if isinstance(data, str):
        session.dispatch("requirements.worst", partial(go_to_worst, place=data))


def _find_largest(session: Session, data: Any) -> None:
    """Search for the largest workspace; nothing is looked at of ``data``."""
    del data
    session.dispatch("largest.start", actions.LARGEST.start, step=False)


def go_to_worst(state: State, place: str) -> State:
    """Go to the pose where a requirement is nearest to its bound, or most beyond it."""
    return poses.move_to(state, text.worst_pose(state, place))


def _asked(state: State) -> bool:
    return asked(state.document.requirements)


REQUIREMENTS = (
    Message("requirement", receive=_select),
    Message("bound", receive=_set_bound),
    Message("worst pose", receive=_go),
    Message("largest workspace", receive=_find_largest),
    Html("requirements.list", content=text.list_html),
    ButtonGroup(
        "requirements.buttons", "", choices=_buttons,
        hint="Add: a bound of one quantity; the suggested set: what the current design can do "
        "around home",
    ),
    Folder("requirements.edit", "Edit", entries=EDIT, visible=has_selected),
    Folder("requirements.workspace", "Headings and workspace", entries=WORKSPACE),
    Checkbox(
        "requirements.hatched", "Hatch the maps", visible=_asked,
        hint="Cells that break a requirement at the maps’ θ and z, in its color",
        **attribute("map_view.hatched"),
    ),
    Answer(
        "requirements.volume", "Where all requirements hold", always=_asked,
        entries=(Html("requirements.volume_text", content=text.volume_html),),
    ),
    Folder(
        "requirements.largest", "Largest workspace", entries=LARGEST_WORKSPACE, open=False,
        visible=lambda state: bool(state.document.requirements.bounds),
    ),
    *(follower.worker for follower in VOLUMES),
)  # fmt: skip
