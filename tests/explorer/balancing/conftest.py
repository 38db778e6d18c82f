"""A state to balance from."""

from __future__ import annotations

import pytest

from paminsa_viz.explorer.motion import actions as motions
from paminsa_viz.explorer.state import State, initial_state


@pytest.fixture(scope="module")
def start() -> State:
    """The state at the start, with a motion in the shape of an arch."""
    return motions.choose_preset(initial_state(), "arch")
