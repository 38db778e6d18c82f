"""The volume's surface, outlines of workspaces, and the best robot of a search in the scene."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
import viser

from paminsa_viz.explorer.core import actions as designs
from paminsa_viz.explorer.core.causes import surface_parts
from paminsa_viz.explorer.features.requirements import actions
from paminsa_viz.explorer.features.requirements.layers import outline
from paminsa_viz.explorer.features.requirements.volumes import find_volume
from paminsa_viz.explorer.features.synthesis import actions as synthesis
from paminsa_viz.explorer.features.synthesis.layers import BEST_NODE
from paminsa_viz.explorer.scene.context import SceneContext
from paminsa_viz.explorer.scene.curves import linear_colors
from paminsa_viz.explorer.scene.nodes import LayerView
from paminsa_viz.explorer.scene.places import found_at
from paminsa_viz.explorer.state.layers import LAYERS
from paminsa_viz.explorer.state.outcome import Outcome, solve
from paminsa_viz.explorer.state.requirements import LargestJob, VolumeJob
from paminsa_viz.explorer.state.state import State, initial_state
from paminsa_viz.explorer.state.synthesis import BestSoFar, Shown
from paminsa_viz.explorer.state.view import Appearance
from paminsa_viz.model import APPENDIX_4
from paminsa_viz.palette import DARK, LIGHT
from paminsa_viz.quantities.requirements import Workspace, WorkspaceShape
from tests.support.raw_page import RawPage
from tests.support.scene import Scene


@pytest.fixture
def layers(server: viser.ViserServer) -> Iterator[Scene]:
    """The views of requirements and synthesis in the scene of a tab."""
    page = RawPage(server)
    scene = page.client.scene
    context = SceneContext(scene)
    keys = ("volume", "required_workspace", "proven_workspace", "best_so_far")
    found = [(LAYERS[key], found_at(LAYERS[key].view)) for key in keys]
    yield Scene(scene, [LayerView(layer, draw, context) for layer, draw in found])
    page.socket.close()


@pytest.fixture(scope="module")
def asked() -> State:
    """The suggested requirements with their volume, coarse."""
    state = actions.suggest(initial_state())
    document = state.document
    outcome = solve(find_volume, VolumeJob(document.design, document.requirements))
    found = outcome.result
    assert found is not None
    outcome = replace(outcome, result=replace(found, surface=surface_parts(found.volume)))
    return state.updated("requirements", fine=outcome)


def test_the_surface_is_of_the_current_design_and_switched_by_its_layer(
    layers: Scene, asked: State
) -> None:
    layers.show(asked)
    outcome = asked.requirements.fine
    assert outcome is not None
    parts = {name for name in layers.shown if name.startswith("/requirements/volume/")}
    assert len(parts) == len(outcome.result.surface) > 1
    assert layers.shown >= parts
    layers.show(designs.vary(asked, {"geometry.base_radius": 0.36}))
    assert not layers.shown & parts
    layers.show(designs.set_layers(asked, volume=False))
    assert not layers.shown & parts
    layers.show(asked)
    assert layers.shown >= parts


def test_required_and_proven_workspaces_are_outlined(layers: Scene, asked: State) -> None:
    layers.show(asked)
    assert "/requirements/required" in layers.shown
    assert "/requirements/proven" not in layers.nodes
    document = asked.document
    workspace = document.requirements.workspace
    assert workspace is not None
    job = LargestJob(document.design, document.requirements, workspace, "ALL", 1.0)
    placed = Workspace(WorkspaceShape.BOX, (0.2, 0.1, 0.3), (0.0, 0.0, -0.5))
    found: Any = SimpleNamespace(workspace=placed)
    proven = asked.updated("requirements.largest", outcome=Outcome(job, found))
    layers.show(proven)
    for appearance, ground in ((Appearance.DARK, DARK), (Appearance.LIGHT, LIGHT)):
        layers.show(replace(proven, appearance=appearance))  # which would swallow a dark line
        for kind, color in (("required", ground.ink), ("proven", ground.good_fill)):
            colors = np.asarray(layers.nodes[f"/requirements/{kind}"].colors).reshape(-1, 3)
            np.testing.assert_array_equal(colors[0], linear_colors(color)[0])
    points = np.asarray(layers.nodes["/requirements/proven"].points).reshape(-1, 3)
    assert points.min(axis=0) == pytest.approx([-0.1, -0.05, -0.65])
    assert points.max(axis=0) == pytest.approx([0.1, 0.05, -0.35])
    layers.show(actions.choose_shape(proven, None))
    assert "/requirements/required" not in layers.shown


@pytest.mark.parametrize("shape", WorkspaceShape)
def test_outlines_have_the_size_of_their_workspace(shape: WorkspaceShape) -> None:
    lines = outline(shape, (0.2, 0.2, 0.4), (0.1, 0.0, -0.5))
    points = np.concatenate(lines)
    assert np.ptp(points, axis=0) == pytest.approx([0.2, 0.2, 0.4])
    assert (points.min(axis=0) + points.max(axis=0)) / 2 == pytest.approx([0.1, 0.0, -0.5])


def test_the_best_robot_is_drawn_while_it_is_searched_for(layers: Scene, asked: State) -> None:
    started = synthesis.start(asked)
    job = started.synthesis.running
    assert job is not None
    layers.show(started)
    assert BEST_NODE not in layers.nodes
    best = BestSoFar(10, 0.4, True, APPENDIX_4, (0.0, 0.0, -0.5))
    told = synthesis.SEARCH.report(started, started.synthesis.ticket, 0.5, best=best)
    layers.show(told)
    assert BEST_NODE in layers.shown
    layers.show(told.updated("synthesis.settings", shown=Shown.ROBOT))
    assert BEST_NODE not in layers.shown
    layers.show(synthesis.SEARCH.stop(told))
    assert BEST_NODE not in layers.shown
