"""Where the platform escapes its actuators: one circle for every theta, and one theta for all.

det = 0 exactly where x^2 + y^2 = R_b^2 + R_pl^2 - 2 R_b R_pl cos theta, or where
cos theta = R_pl / R_b. Toward them the torques of the same robot grow without bound.
"""

import numpy as np

from paminsa_viz.model import (
    APPENDIX_4,
    measure_singularity,
    singular_radius,
    singular_rotation,
    static_torques,
)

geometry = APPENDIX_4.geometry
print(f"every position is singular at θ = {np.degrees(singular_rotation(geometry)):.2f}°")
for degrees in (0, 30, 60):
    radius = float(singular_radius(geometry, np.radians(degrees)))
    print(f"at θ = {degrees:2d}° the singular circle has a radius of {1e3 * radius:.1f} mm")

circle = float(singular_radius(geometry, np.radians(30)))
distance = np.array([0.1, 0.03, 0.01, 0.003, 0.001])  # inside the circle [m]
pose = np.zeros((distance.size, 4))
pose[:, 0], pose[:, 2], pose[:, 3] = circle - distance, np.radians(30), -0.5
near = measure_singularity(geometry, pose)
largest = np.abs(static_torques(APPENDIX_4, pose)[:, :3]).max(axis=1)
print("\nfrom the circle  condition number  largest torque")
for away, condition, torque in zip(near.position_distance, near.condition, largest, strict=True):
    print(f"{1e3 * away:12.1f} mm  {condition:16.1f}  {torque:10.2f} N·m")
