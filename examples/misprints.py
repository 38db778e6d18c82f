"""What each misprint of the paper does to the actuator torques of one motion.

The corrected formulas agree with two physics engines to rounding (see verify_with_mujoco.py); those
as published do not. `docs/model.md` has the table of misprints.
"""

import numpy as np

from paminsa_viz.model import APPENDIX_4, Misprint
from paminsa_viz.trajectory import PRESET, analyze

motion = PRESET["paper-like"].build(APPENDIX_4.geometry).sample(500)
correct = analyze(APPENDIX_4, motion).torque

print("largest change of          M1 [N·m]  M2 [N·m]  M3 [N·m]    M4 [N]")
for misprint in (*Misprint, Misprint.ALL):
    printed = analyze(APPENDIX_4, motion, misprints=misprint).torque
    change = np.abs(printed - correct).max(axis=0)
    name = misprint.name if misprint is not Misprint.ALL else "all of them"
    print(f"{name:24s}" + "".join(f"{value:10.4f}" for value in change))
