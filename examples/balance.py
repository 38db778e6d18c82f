"""The least mass that balances the robot: M_p2 = 0 (Eq. 8), proven to be the least.

Joints 7 and 8 may weigh up to 2 kg, and every bar B3 may carry up to 0.8 kg on a rail of 20 cm
beyond joint 7. The optimum comes with a bound that no other design within these limits beats.
"""

import numpy as np

from paminsa_viz.balancing import Changes, CounterweightRange, MassRange, balance
from paminsa_viz.model import APPENDIX_4, static_imbalance, static_torques

changes = Changes(
    masses=tuple(MassRange(f"joints.j{i}", APPENDIX_4.value(f"joints.j{i}"), 2.0) for i in (7, 8)),
    counterweights=(CounterweightRange("b3", 7, 0.0, 0.2, 0.8),),
)
found = balance(APPENDIX_4, changes)
for path in ("joints.j7", "joints.j8"):
    print(f"{path}: {found.before.value(path):.3f} -> {found.after.value(path):.3f} kg")
for weight in found.after.counterweights:
    print(f"counterweight: {weight.mass:.3f} kg on {weight.place}")
print(f"added mass: {found.objective:.4f} kg; no less than {found.lower_bound:.4f} kg would do")

pose = np.array([0.1, -0.05, 0.3, -0.5])
for design in (found.before, found.after):
    torque = static_torques(design, pose)[:3] + 0.0
    print(f"M_p2 = {static_imbalance(design):8.4f} N, torques {np.round(torque, 6)} N·m")
