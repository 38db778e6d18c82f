"""A tool pushes on the platform: what the actuators give, what they can hold, and how fast it goes.

The spindle's force acts 40 mm off the platform's center and turns with it. Its horizontal moments
load the bearings; no actuator sees them. No drive is chosen, so that default limits count.
"""

from dataclasses import replace

import numpy as np

from paminsa_viz.actuation import capability, wrench_polytope
from paminsa_viz.model import (
    APPENDIX_4,
    LoadCase,
    LoadFrame,
    center_wrench,
    load_torques,
    static_torques,
)

tool = LoadCase(force_x=25.0, force_z=-60.0, point_x=0.04, frame=LoadFrame.PLATFORM)
pose = np.array([0.05, -0.03, 0.3, -0.55])
design = replace(APPENDIX_4, load=tool, name="with a spindle")

wrench = center_wrench(tool, pose[2])
print(f"at the center: F = {np.round(wrench[:3], 3)} N, M = {np.round(wrench[3:], 3)} N·m")
print(f"against it: {np.round(load_torques(design.geometry, tool, pose), 3)} N·m, N")
print(f"held in all: {np.round(static_torques(design, pose), 3)} N·m, N")

at = capability(design, pose)
index, sign = at.horizontal_limit
print(f"in every horizontal direction: {at.horizontal_force:.2f} N, M{index + 1} limits")
print(f"up and down: {at.vertical_force:.1f} N; payload {at.payload:.2f} kg")
print(f"speed {at.speed:.3f} m/s, acceleration {at.acceleration:.2f} m/s^2")

polytope = wrench_polytope(design, pose)
for corner, limit in zip(polytope.section(), polytope.sectors, strict=True):
    print(f"force polygon: {np.round(corner, 1)} N, next side: {limit}")
print(f"nearest face: {polytope.faces[polytope.limiting_face]}")
