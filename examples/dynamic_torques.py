"""Actuator torques along a motion, like the paper's Figs. 6 and 7, and what they are made of.

The motion is ours: a quintic move of all four coordinates with a largest acceleration of 1 m/s^2,
which is all that the paper's text says of its own (Figs. 8-11).
"""

from pathlib import Path

import numpy as np

from paminsa_viz.model import (
    APPENDIX_4,
    inverse_dynamics,
    lumped_coefficients,
    torque_regressor,
)
from paminsa_viz.plots import figure_bytes
from paminsa_viz.trajectory import PRESET, analyze

motion = PRESET["paper-like"].build(APPENDIX_4.geometry).sample(500)
analysis = analyze(APPENDIX_4, motion)
for name, actuator in zip(("M1", "M2", "M3", "M4"), analysis.summary, strict=True):
    unit = "N" if name == "M4" else "N·m"
    print(f"{name}: peak {actuator.peak:7.2f} {unit}, RMS {actuator.rms:7.2f} {unit}")
Path("dynamic_torques.png").write_bytes(figure_bytes("breakdown", analysis, dpi=150))
print("dynamic_torques.png: written")

# The paper's route (Eqs. 15-21) and the product Q = Y(q, q', q'') c are derived separately.
states = motion.pose, motion.velocity, motion.acceleration
multipliers = inverse_dynamics(APPENDIX_4, *states).torque
y = torque_regressor(APPENDIX_4.geometry, *states, gravity=APPENDIX_4.gravity)
product = y @ lumped_coefficients(APPENDIX_4)
print(f"largest difference of the two routes: {np.abs(product - multipliers).max():.1e}")
