"""A server with a scene, and the robot in it."""

from __future__ import annotations

from collections.abc import Iterator

import pytest
import viser

from paminsa_viz.explorer.scene.robot import RobotScene
from paminsa_viz.model.design import APPENDIX_4


@pytest.fixture
def server() -> Iterator[viser.ViserServer]:
    """A server on any free port."""
    running = viser.ViserServer(host="127.0.0.1", port=0, verbose=False)
    yield running
    running.stop()


@pytest.fixture
def robot(server: viser.ViserServer) -> RobotScene:
    """The robot of Appendix 4 in the scene of the server, not yet posed."""
    return RobotScene(server.scene, APPENDIX_4)
