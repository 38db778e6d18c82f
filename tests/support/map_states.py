"""States with maps to look at, and the poses of the cells."""

from __future__ import annotations

import numpy as np

from paminsa_viz.explorer import actions
from paminsa_viz.explorer.state import State, initial_state
from paminsa_viz.plots.map_data import MapData

CELLS = 31


def at(**pose: float) -> State:
    """Return the state at a pose of maps with torques of both signs, or at another one."""
    return actions.move(initial_state(), **({"theta": 0.7, "z": -0.5} | pose))


def poses_of(data: MapData) -> np.ndarray:
    """Return the poses at the middles of the cells, (rows, columns, 4)."""
    x, y = np.meshgrid(data.x, data.y)
    return np.stack([x, y, np.full_like(x, data.theta), np.full_like(x, data.z)], axis=-1)
