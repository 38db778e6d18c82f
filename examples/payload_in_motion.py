"""What a payload asks of the actuators: nothing of M1..M3 at rest, its inertia in motion."""

import numpy as np

from paminsa_viz.actuation import payload_change, payload_time_scaling
from paminsa_viz.balancing import balance
from paminsa_viz.engines import workspace_poses
from paminsa_viz.model import APPENDIX_4, static_torques
from paminsa_viz.trajectory import PRESETS

MASS = 5.0  # kg, on the platform's axis

# The statement of the prototype's authors (J. Mech. Des. 130 (2008) 122303, abstract), at rest:
# with and without a payload M1..M3 need the same torque, and M4 carries k m g more.
poses = workspace_poses(APPENDIX_4.geometry, 500, seed=0)
carrying = APPENDIX_4.vary({"payload.mass": MASS})
change = static_torques(carrying, poses) - static_torques(APPENDIX_4, poses)
weight = APPENDIX_4.geometry.magnification * MASS * APPENDIX_4.gravity
print(f"at rest M1..M3 change by at most {np.abs(change[:, :3]).max():.1g} N·m,")
print(f"M4 by k m g = {weight:.2f} N, to {np.abs(change[:, 3] - weight).max():.0e} N\n")

# In motion the dynamic torques fall with the square of the time. How slow does each motion have to
# be so that the payload changes M1..M3 by 5 % at most? As largest change over largest torque, as
# change of the peak, and as change of the RMS, of the worst of the three actuators.
print("motion       duration   times as slow: largest change     peak      RMS")
for preset in PRESETS:
    motion = preset.build(APPENDIX_4.geometry).sample(500)
    slower = payload_time_scaling(APPENDIX_4, motion, MASS, share=0.05)
    cells = f"{slower.largest:24.3f} {slower.peak:12.3f} {slower.rms:8.3f}"
    print(f"{preset.key:<12}{motion.duration:7.2f} s   {cells}")

# A statically balanced robot has dynamic torques alone: no time scaling changes the share.
balanced = balance(APPENDIX_4).after
motion = PRESETS[0].build(APPENDIX_4.geometry).sample(500)
assert np.isnan(payload_time_scaling(balanced, motion, MASS).largest)
print("\nstatically balanced: no duration is slow enough,")
shares = [f"{100 * payload_change(balanced, motion, MASS, s).largest:.1f} %" for s in (1, 5, 25)]
print(f"the change is {', '.join(shares)} of the peak at 1, 5, 25 times the duration")
