"""Paths across singularities, and what their plans have to keep."""

from __future__ import annotations

from functools import cache

from paminsa_viz.balancing import balance
from paminsa_viz.model import APPENDIX_4
from paminsa_viz.trajectory import MotionLimits
from paminsa_viz.trajectory.paths import straight_path
from paminsa_viz.trajectory.time_optimal import time_optimal

BALANCED = balance(APPENDIX_4).after
TURN = straight_path([0.03, 0.02, 0.8, -0.5], [0.03, 0.02, 1.75, -0.5])
"""A turn through 73.4 degrees, where every position is singular."""
LINE = straight_path([0.1, 0.0, 0.2, -0.5], [0.36, 0.02, 0.5, -0.5])
"""A line through the singular circle."""
TEN = MotionLimits(torque=10.0)

shortest = cache(time_optimal)
"""Plans that several tests look at, worked out once."""
