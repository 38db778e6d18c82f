"""The actions on a document and its view, each a pure function from state to state."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace
from typing import Any, TypeVar

from paminsa_viz.explorer.core.planning import planned
from paminsa_viz.explorer.core.simulated import at_instant
from paminsa_viz.explorer.state.document import Document, LastReachable
from paminsa_viz.explorer.state.layers import with_layers
from paminsa_viz.explorer.state.plane import PlaneJob
from paminsa_viz.explorer.state.state import State, sized
from paminsa_viz.files.design_writer import NAME_CHARACTERS, name_problem
from paminsa_viz.model import APPENDIX_4, Design, InvalidInput, KneeBranch, check_reach
from paminsa_viz.model.design import CHANGED, renamed_if_changed
from paminsa_viz.model.grids import COORDINATES
from paminsa_viz.model.reach import home_pose

AnyPlaneJob = TypeVar("AnyPlaneJob", bound=PlaneJob)

Action = Callable[[State], State]
"""A change of the state; it may raise `PaminsaError`, which changes nothing."""


def with_document(state: State, document: Document) -> State:
    """Return the state with another document; the robot follows it if the pose can be taken.

    While the robot follows the motion, its pose is that of the instant that is shown, or where the
    simulated robot is if that is shown; where the motion fails, it stays. Of another motion that is
    over before that instant, its end is shown.
    """
    was, motion = state.document.design.geometry, state.document.motion
    state = sized(replace(state, document=with_names_apart(document)), was)
    document, time = state.document, state.playback.time
    # A plan may take long: at the start of a motion, only who draws the state needs it.
    if time > 0.0 and document.motion != motion:
        trajectory = planned(document.motion, document.design).trajectory
        end = 0.0 if trajectory is None else trajectory.duration
        state = state.updated("playback", time=min(time, end))
    if state.playback.following:
        document = at_instant(document, state.simulation, state.playback.time)
    last_reachable = state.last_reachable
    if check_reach(document.design.geometry, document.pose).ok.all():
        last_reachable = LastReachable(document.design.geometry, document.pose)
    return replace(state, document=document, last_reachable=last_reachable)


def change_document(state: State, **changes: Any) -> State:
    """Change attributes of the document."""
    return with_document(state, replace(state.document, **changes))


def with_names_apart(document: Document) -> Document:
    """Return the document, its design under another name if a different reference has the same."""
    design, reference = document.design, document.reference
    if reference is None or design.name != reference.name or design == reference:
        return document
    name = another_name(reference.name)
    return replace(document, design=replace(design, name=name))


def another_name(name: str) -> str:
    """Return the name for a changed design: ``arm, changed``, then ``arm, changed 2``."""
    base, found, count = name.rpartition(CHANGED)
    if not found or (count and not count.strip().isdecimal()):
        base, ending = name, CHANGED
    else:
        ending = f"{CHANGED} {int(count or 1) + 1}"
    return base[: NAME_CHARACTERS - len(ending)] + ending


def move(state: State, **coordinates: float) -> State:
    """Ask for another pose; named coordinates change [m, m, rad, m]."""
    pose = dict(zip(COORDINATES, state.document.pose, strict=True)) | coordinates
    moved = (pose["x"], pose["y"], pose["theta"], pose["z"])
    return change_document(stop_following(state), pose=moved)


def move_to(state: State, pose: Iterable[float] | None) -> State:
    """Ask for a pose that was found [m, m, rad, m], without its rounding errors; None stays."""
    if pose is None:
        return state
    found = (round(float(value), 9) + 0.0 for value in pose)
    return move(state, **dict(zip(COORDINATES, found, strict=True)))


def stop_following(state: State) -> State:
    """Take the robot off its motion, which stops being played."""
    if not state.playback.following:
        return state
    return state.updated("playback", playing=False, following=False)


def go_home(state: State) -> State:
    """Ask for the home pose."""
    home = home_pose(state.document.design.geometry)
    return change_document(stop_following(state), pose=home)


def vary(state: State, changes: Mapping[str, float | None]) -> State:
    """Change numbers of the design.

    Raises:
        InvalidDesign: If no machine can have them.
    """
    return with_design(state, state.document.design.vary(changes))


def with_design(state: State, design: Design) -> State:
    """Return the state with a changed design, see `renamed_if_changed`."""
    return change_document(state, design=renamed_if_changed(design))


def change_design(state: State, **changes: Any) -> State:
    """Change attributes of the design.

    Raises:
        InvalidDesign: If no machine can have them.
    """
    return with_design(state, replace(state.document.design, **changes))


def reset_values(state: State, paths: tuple[str, ...]) -> State:
    """Set numbers of the design back to Appendix 4's."""
    return vary(state, {path: APPENDIX_4.stored(path) for path in paths})


def load_design(state: State, design: Design) -> State:
    """Work on another design, at the current pose if it can be taken, else at home.

    With another branch of the knee the pose is the mirrored one, as in `set_knee`.
    """
    document = with_knee(state.document, design.geometry.knee)
    changed = with_document(state, replace(document, design=design))
    if changed.last_reachable.geometry is not design.geometry:
        changed = go_home(changed)
    return changed


def set_knee(state: State, knee: KneeBranch) -> State:
    """Put the robot, and the reference with it, together on another branch of the knee.

    The platform goes to the mirrored height (z_5 to -z_5).
    """
    if knee is state.document.design.geometry.knee:
        return state
    return with_document(state, with_knee(state.document, knee))


def with_knee(document: Document, knee: KneeBranch) -> Document:
    """Return the document with its robots on a branch of the knee, at the mirrored pose."""
    design, reference = document.design, document.reference
    if knee is design.geometry.knee:
        return document
    x, y, theta, z = document.pose
    return replace(
        document,
        design=design.with_knee(knee),
        pose=(x, y, theta, -z - 2 * design.geometry.platform_joint_height),
        reference=None if reference is None else reference.with_knee(knee),
    )


def pin_reference(state: State) -> State:
    """Keep the current design to compare with."""
    return change_document(state, reference=state.document.design)


def appendix_of(state: State) -> Design:
    """Return the robot of Appendix 4, on the knee's branch of the design."""
    return APPENDIX_4.with_knee(state.document.design.geometry.knee)


def pin_appendix(state: State) -> State:
    """Compare with Appendix 4."""
    return change_document(state, reference=appendix_of(state))


def unpin_reference(state: State) -> State:
    """Forget the reference design; maps show values again."""
    return change_document(state, reference=None).updated("map_view", difference=False)


def swap_reference(state: State) -> State:
    """Work on the reference, and keep the current design to compare with."""
    document = state.document
    if document.reference is None:
        return state
    swapped = load_design(state, document.reference)
    return change_document(swapped, reference=document.design)


def rename(state: State, name: str) -> State:
    """Give the design another name.

    Raises:
        InvalidInput: If a design file cannot hold it.
    """
    problem = name_problem(name)
    if problem:
        raise InvalidInput("name", problem)
    return change_document(state, design=replace(state.document.design, name=name))


def restore(state: State, document: Document) -> State:
    """Take over a whole document, as undo, redo and a reload do."""
    changed = with_document(stop_following(state), document)
    if document.reference is None and changed.map_view.difference:
        changed = changed.updated("map_view", difference=False)
    return changed


def set_layers(state: State, **visible: bool) -> State:
    """Show and hide layers of the scene, by their keys."""
    return replace(state, layers=with_layers(state.layers, visible))


def plane_job(kind: type[AnyPlaneJob], state: State, settings: Any, *more: Any) -> AnyPlaneJob:
    """Return a job on the current design in the plane of the maps, of a kind of `PlaneJob`."""
    document = state.document
    _, _, theta, z = document.pose
    return kind(document.design, theta, z, state.condition_limit, settings, *more)
