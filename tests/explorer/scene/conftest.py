"""A server, and the robot's layers in its scene."""

from __future__ import annotations

from collections.abc import Iterator

import pytest
import viser

from paminsa_viz.explorer.scene.layers import SceneContext, build_views
from tests.explorer.scene.seen import Scene


@pytest.fixture
def server() -> Iterator[viser.ViserServer]:
    """A server on any free port."""
    running = viser.ViserServer(host="127.0.0.1", port=0, verbose=False)
    yield running
    running.stop()


@pytest.fixture
def scene(server: viser.ViserServer) -> Scene:
    """All animated layers in the scene of the server; nothing is drawn yet."""
    return Scene(server, build_views(SceneContext(server.scene), animated=True))
