"""The corrected formulas against MuJoCo, an independent physics engine (paper: Figs. 6 and 7).

MuJoCo is part of the installation. `paminsa-viz verify` does more: a second engine, Pinocchio (`pip
install "paminsa-viz[verify]"`), each misprint by itself, a simulation, figures and a verdict.
"""

import numpy as np

from paminsa_viz.engines import MujocoRobot
from paminsa_viz.model import APPENDIX_4, Misprint, inverse_dynamics
from paminsa_viz.trajectory import PRESET

robot = MujocoRobot(APPENDIX_4)
motion = PRESET["paper-like"].build(APPENDIX_4.geometry).sample(200)
states = motion.pose, motion.velocity, motion.acceleration
measured = robot.inverse_dynamics(*states)

for name, misprints in (("corrected", Misprint.NONE), ("as published", Misprint.ALL)):
    calculated = inverse_dynamics(APPENDIX_4, *states, misprints=misprints).torque
    difference = np.abs(calculated - measured).max(axis=0) / np.abs(measured).max(axis=0)
    words = ", ".join(f"{value:.1e}" for value in difference)
    print(f"{name}: M1 to M4 differ from MuJoCo by {words} of their largest torque")
