"""Puts one tab together: its session, the first panel, then the robot, then all the rest.

What comes later is imported later: the first panel is there before trimesh is.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import viser

from paminsa_viz.explorer.browser import SOFTWARE_RENDERERS
from paminsa_viz.explorer.browser.bridge import finite
from paminsa_viz.explorer.browser.style import CONTROLS_WIDTH, style_html
from paminsa_viz.explorer.browser.tour import offer_tour
from paminsa_viz.explorer.core import actions, tab_store
from paminsa_viz.explorer.core.docks import fit_right, keep_docks
from paminsa_viz.explorer.core.frame import Health, compute
from paminsa_viz.explorer.core.links import open_link
from paminsa_viz.explorer.core.session import Session
from paminsa_viz.explorer.features.synthesis.actions import previewed
from paminsa_viz.explorer.features.view.theme import ThemeView, TitleView
from paminsa_viz.explorer.kit.bindings import Panel
from paminsa_viz.explorer.scene.build import build_views
from paminsa_viz.explorer.scene.context import SceneContext
from paminsa_viz.explorer.server.limits import Limits
from paminsa_viz.explorer.state.state import State, initial_state
from paminsa_viz.explorer.state.stiffness import MODE_NODE
from paminsa_viz.explorer.strip import STRIP, restartable
from paminsa_viz.explorer.tabs import (
    EARLIER,
    WORKSPACES,
    add_tabs,
    build_rest,
    enter_workspace,
    fill,
    sections,
)
from paminsa_viz.model import Design
from paminsa_viz.model.resizing import plain_decimals, radius_ratio
from paminsa_viz.quantities.requirements import Requirements


def has_graphics_card(renderer: object) -> bool:
    """Return whether what a browser names as its renderer is more than a program."""
    name = renderer.lower() if isinstance(renderer, str) else ""
    return bool(name) and not any(word in name for word in SOFTWARE_RENDERERS)


OPENING = (0.08, 0.05, np.pi / 3)
"""x, y [m] at Appendix 4's R_b and theta [rad] that a new page opens at: the angle of the
paper's Fig. 3, and a position at which gravity loads all actuators."""


def opening_state(design: Design, requirements: Requirements | None = None) -> State:
    """Return the state a page opens with: at home, if the robot cannot be at `OPENING`."""
    start = initial_state(design)
    if requirements is not None:
        start = start.updated("document", requirements=requirements)
    x, y, theta = OPENING
    size, decimals = radius_ratio(design.geometry), plain_decimals(design.geometry)
    x, y = round(size * x, decimals), round(size * y, decimals)
    moved = actions.move(start, x=x, y=y, theta=theta)
    return moved if compute(moved).health is Health.OK else start


def build(
    client: viser.ClientHandle, design: Design, requirements: Requirements | None = None
) -> Session:
    """Build the page of a tab that has just connected, and start its worker.

    The first tab comes first; once the browser has drawn it the robot, and then the rest, so that
    nobody waits for it. Whoever adds views dispatches a new state, so that they are drawn.
    """
    opening = opening_state(design, requirements)
    session = Session(client, opening, shown=previewed)
    session.paths = {section.name: path for path, section in sections().items()}
    bridge, gui = session.bridge, client.gui
    theme, title = ThemeView(session), TitleView(session)
    gui.set_panel_label("PAMINSA")
    gui.main_panel.dock_right()
    gui.main_panel.set_width(CONTROLS_WIDTH)

    gui.add_html(style_html())
    strip = Panel(session, STRIP)
    file_place = gui.add_folder("File", expand_by_default=False)
    places = add_tabs(gui)
    first_path = next(iter(places))
    with places[first_path]:
        first = fill(session, first_path)
    session.fast += [theme, title, strip, first]
    context = SceneContext(
        client.scene, session.dispatch, client.camera, lambda: session.pixel_ratio
    )

    def fit_robot() -> None:
        """Follow what the page has said of its size after the robot was built."""
        from paminsa_viz.explorer.scene.cameras import fit

        if session.immediate:
            fit(session)

    def build_robot() -> None:
        from paminsa_viz.explorer.scene.cameras import (
            SizeView,
            follow_resizes,
            keep_camera,
            look,
            place,
        )

        if session.immediate:
            return
        look(session, "3D")
        if session.state.camera is not None:
            place(session)
        follow_resizes(session)
        keep_camera(session)
        session.immediate += [*build_views(context, animated=True), SizeView(session)]
        session.dispatch("robot", replace)

    def complete() -> None:
        if session.built.is_set():
            return
        build_rest(session, places, file_place, context)
        session.built.set()
        enter_workspace(session)
        session.fit_docks()
        offer_tour(bridge)
        session.dispatch("page", replace)

    def restore(saved: object) -> None:
        if isinstance(saved, str):
            session.dispatch(
                "restore", lambda state: tab_store.take(state, saved, opening), step=False
            )
            session.submit(announce)
        # In its turn: a drawing that goes on is of the state before.
        session.submit(session.restored.set)
        if session.built.is_set():  # too late: what was set meanwhile has to be kept
            session.dispatch("hello", replace, step=False)

    def announce() -> None:
        if restartable(session.state):
            session.notify(
                "A reload keeps no results of searches",
                "What is set was kept. Above the tabs, what ran or was found can be started again.",
            )
        if session.state.offered:
            session.notify(
                "This tab has kept another state",
                "It was not written over what was opened or set before it came. "
                "“Kept state”, above the tabs, opens it.",
            )

    def choose_detail(renderer: object) -> None:
        if has_graphics_card(renderer):
            session.dispatch("graphics", lambda state: actions.set_layers(state, fine=True))
        else:
            bridge.call("renderOnDemand", MODE_NODE)

    def take_window(data: object) -> None:
        found = [finite(one) for one in data] if isinstance(data, list) else []
        match found:
            case [float(width), float(height)] if min(width, height) >= 1:
                session.set_window(width, height)
                # In its turn: the robot may just be built, for the size that was known before.
                session.submit(fit_robot)

    def take_tabs(names: object) -> None:
        if not isinstance(names, list):
            return
        session.open_tabs = frozenset(map(str, names))
        session.dispatch("tabs", replace, step=False)
        if session.built.is_set():
            enter_workspace(session)

    layers = {one.name: frozenset(one.layers) for one in WORKSPACES}
    keep_docks(session)
    bridge.on("window", take_window)
    bridge.on("window", lambda _: session.submit(lambda: fit_right(session)))
    bridge.on("tabs", take_tabs)
    bridge.on("undo", lambda _: session.undo())
    bridge.on("redo", lambda _: session.redo())
    bridge.on("link", lambda link: open_link(session, link, layers))
    bridge.on("hello", restore)
    bridge.on("hello", lambda _: session.submit(lambda: fit_right(session)))
    bridge.on("hello", lambda _: session.submit(fit_robot))
    bridge.on("graphics", choose_detail)
    bridge.on("painted", lambda _: session.submit(build_robot))
    for kind in ("shown", "late"):
        bridge.on(kind, lambda _: session.submit(build_robot))
        bridge.on(kind, lambda _: session.submit(complete))
    bridge.open({**session.paths, **EARLIER}, largest_file=Limits.upload_bytes)
    session.start()
    return session
