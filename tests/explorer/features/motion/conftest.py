"""What tests of motions on the page share."""

from __future__ import annotations

import pytest

from paminsa_viz.explorer.core import actions
from paminsa_viz.explorer.state.state import State, initial_state


@pytest.fixture
def state() -> State:
    """A design of its own on the paper-like motion, its torques next to the engine's."""
    changed = actions.vary(initial_state(), {"payload.mass": 2.0, "links.b4": 0.9})
    return changed.updated("plots", engine=True, published=True)
