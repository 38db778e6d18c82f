"""How far the platform may be off: by its drives, and by the tolerances of its lengths.

The linear estimate is compared with exact kinematics on the way to the fold, where the two assembly
modes meet; tolerances are compared with robots drawn at random.
"""

from dataclasses import replace

import numpy as np

from paminsa_viz import APPENDIX_4
from paminsa_viz.model import singular_rotation
from paminsa_viz.precision import LENGTHS, drive_errors, monte_carlo, tolerance_errors

UM, ARCSEC = 1e6, np.degrees(1) * 3600
fold = float(np.degrees(singular_rotation(APPENDIX_4.geometry)))

print("errors of theta from half a count of 0.01° and 10 µm, at the center:")
for angle in (0.0, 45.0, 65.0, 70.0, 72.0, 72.9):
    found = drive_errors(APPENDIX_4.geometry, APPENDIX_4.accuracy, (0, 0, np.radians(angle), -0.3))
    linear, worst = found.linear[2] * ARCSEC, found.worst[2] * ARCSEC
    exact = f"exact {worst:7.1f}″" if found.ok else f"no bound: {found.reason()}"
    print(f"  {angle:5.1f}°, {fold - angle:5.1f}° to the fold: linear {linear:7.1f}″, {exact}")

# Bars to 20 µm in place of the standard's tolerance
better = replace(APPENDIX_4, tolerances=replace(APPENDIX_4.tolerances, bar=20e-6, shaft=20e-6))
pose = (0.05, 0.02, 0.3, -0.5)
for name, design in (("ISO 2768-f", APPENDIX_4), ("bars and shafts to 20 µm", better)):
    found, drawn = tolerance_errors(design, pose), monte_carlo(design, pose, robots=500, seed=1)
    most = LENGTHS[int(np.argmax(found.shares[3]))]
    print(
        f"{name}: z off by {found.worst[3] * UM:.0f} µm at worst, {found.rms[3] * UM:.0f} µm RMS "
        f"({drawn.rms[3] * UM:.0f} µm of 500 robots, seed {drawn.seed}), mostly by {most.label}"
    )
