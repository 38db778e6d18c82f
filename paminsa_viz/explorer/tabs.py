"""The workspaces of the page with their sections, in their order, and what is built with them.

What a section holds is imported when it is filled: the first one is there before trimesh is.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import viser

from paminsa_viz.explorer.core.docks import BESIDE, left_dock
from paminsa_viz.explorer.core.session import Session
from paminsa_viz.explorer.core.tab_store import TabStore
from paminsa_viz.explorer.core.workspaces import switch, view_of
from paminsa_viz.explorer.kit.bindings import Panel
from paminsa_viz.explorer.kit.entries import Button, ButtonGroup, Entry, Folder
from paminsa_viz.explorer.scene.build import build_views
from paminsa_viz.explorer.scene.context import SceneContext
from paminsa_viz.explorer.state.state import State

if TYPE_CHECKING:
    from paminsa_viz.explorer.commands import Command
    from paminsa_viz.explorer.kit.answers import PlacedAnswer

Entries = Sequence[Entry]


@dataclass(frozen=True)
class PageSection:
    """A section of a workspace.

    Attributes:
        name: What it is called; no other section has the name.
        entries: Returns what it holds; called when it is filled.
        words: What else a person may look for it by, in the command palette.
    """

    name: str
    entries: Callable[[], Entries]
    words: str = ""


@dataclass(frozen=True)
class PageWorkspace:
    """A workspace: all that one question needs.

    Attributes:
        name: What it is called.
        question: What it answers.
        sections: What it holds, in their order.
        beside: Name of the tab of the left dock that opens with it at first.
        layers: Layers of the scene that are shown with it at first, next to those that are shown.
    """

    name: str
    question: str
    sections: tuple[PageSection, ...]
    beside: str
    layers: tuple[str, ...] = ()

    def path(self, section: PageSection) -> str:
        """Return the path of the tab of a section, see `Session.open_tab`."""
        return f"{self.name}/{section.name}"


def _pose() -> Entries:
    from paminsa_viz.explorer.features.pose.tab import POSE

    return POSE


def _lengths() -> Entries:
    from paminsa_viz.explorer.features.design.tab import LENGTHS

    return LENGTHS


def _masses() -> Entries:
    from paminsa_viz.explorer.features.design.tab import MASSES

    return MASSES


def _load() -> Entries:
    from paminsa_viz.explorer.features.design.tab import LOAD

    return LOAD


def _path() -> Entries:
    from paminsa_viz.explorer.features.motion.tab import MOTION

    return MOTION


def _drives() -> Entries:
    from paminsa_viz.explorer.features.drives.tab import DRIVES

    return DRIVES


def _simulate() -> Entries:
    from paminsa_viz.explorer.features.motion.tab import SIMULATING

    return SIMULATING


def _loads() -> Entries:
    from paminsa_viz.explorer.features.loads.tab import LOADS

    return LOADS


def _stiffness() -> Entries:
    from paminsa_viz.explorer.features.stiffness.tab import STIFFNESS

    return STIFFNESS


def _errors() -> Entries:
    from paminsa_viz.explorer.features.accuracy.tab import ACCURACY

    return ACCURACY


def _requirements() -> Entries:
    from paminsa_viz.explorer.features.requirements.tab import REQUIREMENTS

    return REQUIREMENTS


def _balance() -> Entries:
    from paminsa_viz.explorer.features.balance.tab import balance_entries
    from paminsa_viz.explorer.features.springs.tab import SPRINGS
    from paminsa_viz.explorer.features.tolerances.tab import TOLERANCES

    return balance_entries(
        Folder("balance.springs", "Springs", entries=SPRINGS, open=False),
        Folder("balance.tolerances", "Tolerances", entries=TOLERANCES, open=False),
    )


def _synthesis() -> Entries:
    from paminsa_viz.explorer.features.synthesis.tab import SYNTHESIZE

    return SYNTHESIZE


def _logs() -> Entries:
    from paminsa_viz.explorer.features.identification.tab import LOGS

    return LOGS


def _excite() -> Entries:
    from paminsa_viz.explorer.features.identification.tab import EXCITE

    return EXCITE


def _calibrate() -> Entries:
    from paminsa_viz.explorer.features.calibration.tab import CALIBRATION

    return CALIBRATION


WORKSPACES = (
    PageWorkspace(
        "Robot", "What is it, and where does it stand?",
        (
            PageSection("Pose", _pose, "position, heading, knee, home, undo, condition number"),
            PageSection("Lengths", _lengths, "geometry, bars, radii, guide, pantograph"),
            PageSection("Masses", _masses, "inertia, payload, friction, gravity, M_p2"),
            PageSection("Load", _load, "external force, moment"),
        ),
        "Torque maps", ("floor_map", "singularity"),
    ),
    PageWorkspace(
        "Motion", "Can it move so, and with which motors?",
        (
            PageSection(
                "Path", _path, "motion, play, preset, points, time law, trajectory, duration"
            ),
            PageSection("Drives", _drives, "motors, gears, encoders, catalog, select"),
            PageSection("Simulate", _simulate, "controller, feed-forward, MuJoCo, payload error"),
        ),
        "Motion plots", ("path",),
    ),
    PageWorkspace(
        "Strength", "Does it hold, and how exact is it?",
        (
            PageSection(
                "Loads", _loads, "joint forces, bearings, bars, stress, N V M, utilization"
            ),
            PageSection("Stiffness", _stiffness, "stiff, compliance, vibration, frequency, mode"),
            PageSection("Errors", _errors, "accuracy, encoder, backlash, resolution, manufacture"),
        ),
        "Answer",
    ),
    PageWorkspace(
        "Optimize", "What should it be?",
        (
            PageSection("Requirements", _requirements, "bounds, workspace, proof, volume"),
            PageSection("Balance", _balance, "counterweights, springs, tolerances, Pareto"),
            PageSection("Synthesis", _synthesis, "search, lengths, design, lightest robot, front"),
        ),
        "Answer", ("volume",),
    ),
    PageWorkspace(
        "Built", "Does the real one agree?",
        (
            PageSection("Logs", _logs, "identify, identification, measured, residuals, friction"),
            PageSection("Excite", _excite, "motion for a log, experiment, D-optimal"),
            PageSection(
                "Calibrate", _calibrate,
                "calibration, kinematic calibration, laser tracker, measure poses, leg lengths",
            ),
        ),
        "Answer", ("path",),
    ),
)  # fmt: skip
"""Every workspace. The first section of the first one is filled at once, the others later."""


def sections() -> dict[str, PageSection]:
    """Return all sections by the paths of their tabs."""
    return {one.path(section): section for one in WORKSPACES for section in one.sections}


EARLIER = {
    "Design": "Robot/Masses", "Motion": "Motion/Path", "Accuracy": "Strength/Errors",
    "Identify": "Built/Logs", "Identification": "Built/Logs", "Synthesize": "Optimize/Synthesis",
}  # fmt: skip
"""Tabs that had another name, for what a browser has kept of before."""


def enter_workspace(session: Session) -> None:
    """Take over which workspace is open; one that was not is shown as it was left."""
    from paminsa_viz.explorer.scene.cameras import camera_of, place  # late: shapes

    open_tabs, known = session.open_tabs or frozenset(), {one.name: one for one in WORKSPACES}
    name = next((name for name in known if name in open_tabs), None)
    if name is None:
        return
    beside = next((one for one in BESIDE if one in open_tabs), "")
    left_from: State | None = None

    def go(state: State) -> State:
        nonlocal left_from
        if name == state.workspace:  # asked here: on the way to another one the page may go back
            return state
        left_from = state
        state = replace(state, camera=camera_of(session))
        folded = left_dock(state, session.window)[1]
        if state.workspace and state.workspace != name and not folded:
            left = view_of(state, name)
            session.open_tab(known[name].beside if left is None or not left.beside else left.beside)
        return switch(state, name, beside, frozenset(known[name].layers))

    def arrive() -> None:
        if left_from is None:
            return
        place(session)
        if session.state.docks != left_from.docks:
            session.fit_docks()

    session.dispatch("workspace", go, step=False, then=arrive)


def load() -> None:
    """Import what later sections and docks hold, so that nobody waits for it."""
    from paminsa_viz.explorer import commands, dock  # noqa: F401

    for section in sections().values():
        section.entries()


def add_tabs(gui: viser.GuiApi) -> dict[str, Any]:
    """Add the empty tabs of workspaces and sections; return those of sections by their paths."""
    places: dict[str, Any] = {}
    group = gui.add_tab_group()
    for workspace in WORKSPACES:
        with group.add_tab(workspace.name):
            inner = gui.add_tab_group()
            for section in workspace.sections:
                places[workspace.path(section)] = inner.add_tab(section.name)
    return places


def answers() -> list[PlacedAnswer]:
    """Return the answers of all sections, in their order."""
    from paminsa_viz.explorer.features.compare.tab import COMPARISON
    from paminsa_viz.explorer.kit.answers import answers_of

    found = list(answers_of((COMPARISON,)))
    for path, section in sections().items():
        found += answers_of(section.entries(), path)
    return found


def fill(session: Session, path: str) -> Panel:
    """Fill the tab of a section, in the current container."""
    return Panel(session, sections()[path].entries(), path)


def places_to_go() -> list[Command]:
    """Return the commands that open workspaces, sections and the tabs of the left dock."""
    from paminsa_viz.explorer.commands import Command, open_effect

    found = [
        Command(
            f"open.{one.name}", f"Workspace: {one.name}", open_effect(one.name), str(number),
            "cmd/ctrl", words=one.question, name=one.name,
        )
        for number, one in enumerate(WORKSPACES, start=1)
    ]  # fmt: skip
    found += [
        Command(
            f"open.{path}", f"Open: {section.name} ({path.partition('/')[0]})",
            open_effect(section.name), words=section.words, name=section.name,
        )
        for path, section in sections().items()
    ]  # fmt: skip
    found += [
        Command(f"open.{tab}", f"Open: {tab}", open_effect(tab), words=words, name=tab)
        for tab, words in BESIDE.items()
    ]
    return found


def exports_of(entries: Entries) -> list[Command]:
    """Return a command for each file that a table of exports offers."""
    from paminsa_viz.explorer.commands import Command
    from paminsa_viz.explorer.features.export.tab import SUBJECTS, volume_choices

    found: list[Command] = []
    for entry in entries:
        if not isinstance(entry, ButtonGroup):
            continue
        choices = entry.choices
        shown = choices if isinstance(choices, Mapping) else volume_choices()
        found += [
            Command(
                f"{entry.key}.{label}", f"Export: {label} ({SUBJECTS[entry.key]})", effect,
                undo=False, words=str(entry.hint),
            )
            for label, effect in shown.items()
        ]  # fmt: skip
    return found


def files_of(entries: Entries) -> list[Command]:
    """Return a command for each button of the folders in a table."""
    from paminsa_viz.explorer.commands import Command

    buttons = [
        entry
        for folder in entries
        if isinstance(folder, Folder)
        for entry in folder.entries
        if isinstance(entry, Button)
    ]
    return [
        Command(
            one.key, f"File: {one.label}", one.effect, *(one.keys or (None, None)),
            undo=False, words=str(one.hint),
        )
        for one in buttons
    ]  # fmt: skip


def build_rest(
    session: Session, places: Mapping[str, Any], file_place: Any, context: SceneContext
) -> None:
    """Fill the later tabs, and add the docks and the layers on the ground.

    The session draws them with its next state.

    Args:
        session: The tab of the browser.
        places: The tabs of the sections by their paths; the first one is filled.
        file_place: The empty folder of files.
        context: What the layers of the scene are made with.
    """
    from paminsa_viz.explorer.commands import register_commands
    from paminsa_viz.explorer.dock import MapsPanel, view_panel
    from paminsa_viz.explorer.features.export.tab import export_entries
    from paminsa_viz.explorer.features.files.tab import FILE
    from paminsa_viz.explorer.features.inspector.panel import Inspector
    from paminsa_viz.explorer.features.maps.cursor import Cursor

    maps = MapsPanel(session, answers())
    late: list[Panel] = []
    for path in list(sections())[1:]:
        with places[path]:
            session.fast.append(fill(session, path))
    exported = export_entries(maps.store, maps.legend)
    folder = Folder("file.export", "Export", entries=exported, open=False)
    with file_place:
        late.append(Panel(session, (*FILE, folder)))
    session.fast += [view_panel(session), Inspector(session)]
    session.ground = build_views(
        replace(context, maps=maps.store, legend=maps.legend), animated=False
    )
    session.deferred += [maps, *session.ground, maps.legend, *late, TabStore(session)]
    Cursor(session, context.scene)
    register_commands(session, (*places_to_go(), *files_of(FILE), *exports_of(exported)))
