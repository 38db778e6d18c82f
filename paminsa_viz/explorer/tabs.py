"""The tabs of the page, in their order, and the rest of the page that is built with them.

What a tab holds is imported when it is filled: the first one is there before trimesh is.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from paminsa_viz.explorer.core.session import Session
from paminsa_viz.explorer.core.tab_store import TabStore
from paminsa_viz.explorer.kit.bindings import Panel
from paminsa_viz.explorer.kit.entries import Entry, Folder
from paminsa_viz.explorer.scene.build import build_views
from paminsa_viz.explorer.scene.context import SceneContext

Entries = Sequence[Entry]


@dataclass(frozen=True)
class Tab:
    """A tab of the page.

    Attributes:
        name: What it is called.
        entries: Returns what it holds; called when it is filled.
        fast: Whether it is drawn a moment after the robot, and not after maps and other figures.
    """

    name: str
    entries: Callable[[], Entries]
    fast: bool = True


def _pose() -> Entries:
    from paminsa_viz.explorer.features.pose.tab import POSE

    return POSE


def _design() -> Entries:
    from paminsa_viz.explorer.features.design.tab import DESIGN

    return DESIGN


def _balance() -> Entries:
    from paminsa_viz.explorer.features.balance.tab import balance_entries
    from paminsa_viz.explorer.features.springs.tab import SPRINGS
    from paminsa_viz.explorer.features.tolerances.tab import TOLERANCES

    return balance_entries(
        Folder("balance.springs", "Springs", entries=SPRINGS, open=False),
        Folder("balance.tolerances", "Tolerances", entries=TOLERANCES, open=False),
    )


def _motion() -> Entries:
    from paminsa_viz.explorer.features.motion.tab import MOTION

    return MOTION


def _drives() -> Entries:
    from paminsa_viz.explorer.features.drives.tab import DRIVES

    return DRIVES


def _loads() -> Entries:
    from paminsa_viz.explorer.features.loads.tab import LOADS

    return LOADS


def _accuracy() -> Entries:
    from paminsa_viz.explorer.features.accuracy.tab import ACCURACY

    return ACCURACY


def _stiffness() -> Entries:
    from paminsa_viz.explorer.features.stiffness.tab import STIFFNESS

    return STIFFNESS


def _identification() -> Entries:
    from paminsa_viz.explorer.features.identification.tab import IDENTIFY

    return IDENTIFY


def _requirements() -> Entries:
    from paminsa_viz.explorer.features.requirements.tab import REQUIREMENTS

    return REQUIREMENTS


def _synthesis() -> Entries:
    from paminsa_viz.explorer.features.synthesis.tab import SYNTHESIZE

    return SYNTHESIZE


def _compare() -> Entries:
    from paminsa_viz.explorer.features.compare.tab import COMPARE

    return COMPARE


def _view() -> Entries:
    from paminsa_viz.explorer.features.clearance.tab import CLEARANCE
    from paminsa_viz.explorer.features.view.tab import view_entries

    return (*view_entries(), *CLEARANCE)


def _files() -> Entries:
    from paminsa_viz.explorer.features.files.tab import FILE

    return FILE


TABS = (
    Tab("Pose", _pose),
    Tab("Design", _design),
    Tab("Balance", _balance),
    Tab("Motion", _motion),
    Tab("Drives", _drives),
    Tab("Loads", _loads),
    Tab("Accuracy", _accuracy),
    Tab("Stiffness", _stiffness),
    Tab("Identification", _identification),
    Tab("Requirements", _requirements),
    Tab("Synthesis", _synthesis),
    Tab("Compare", _compare, fast=False),
    Tab("View", _view),
    Tab("File", _files, fast=False),
)
"""Every tab. The first one is filled at once, the others when the page is there."""


def load() -> None:
    """Import what the later tabs and the dock hold, so that nobody waits for it."""
    from paminsa_viz.explorer import commands, dock  # noqa: F401

    for tab in TABS:
        tab.entries()


def fill(session: Session, tab: Tab) -> Panel:
    """Fill a tab, in the current container."""
    return Panel(session, tab.entries(), tab.name)


def build_rest(session: Session, places: Mapping[str, Any], context: SceneContext) -> None:
    """Fill the later tabs, and add the dock and the layers on the ground.

    The session draws them with its next state.

    Args:
        session: The tab of the browser.
        places: The empty tabs by name.
        context: What the layers of the scene are made with.
    """
    from paminsa_viz.explorer.commands import register_commands
    from paminsa_viz.explorer.dock import MapsPanel

    maps = MapsPanel(session)
    late: list[Panel] = []
    for tab in TABS[1:]:
        with places[tab.name]:
            (session.fast if tab.fast else late).append(fill(session, tab))
    floor = build_views(replace(context, maps=maps.store, legend=maps.legend), animated=False)
    session.deferred += [maps, *floor, maps.legend, *late, TabStore(session)]
    register_commands(session)
