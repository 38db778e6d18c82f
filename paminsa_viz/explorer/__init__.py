"""The web page: state, actions, session, 3D scene, panels.

Public is what the data of a feature is made of; the page itself is started by ``paminsa-viz``.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from paminsa_viz.late import late_names

if TYPE_CHECKING:
    from paminsa_viz.explorer.state.outcome import TaskState, solve
    from paminsa_viz.explorer.state.settings import Settings, setting

__all__ = [
    "Settings",
    "TaskState",
    "setting",
    "solve",
]

__getattr__ = late_names(__name__)
