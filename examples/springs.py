"""Springs and counterweights against gravity, compared on the same map.

A spring of free length zero from a mast on slider 8 to joint 9 balances the robot as exactly as a
counterweight does, and weighs nothing. From a post on the guide link it only comes near, and a
spring that has a length of its own does as the stiffness and length found for it allow.
"""

import numpy as np

from paminsa_viz import APPENDIX_4, static_torques, xy_grid
from paminsa_viz.balancing import (
    SpringPlace,
    at_joint,
    balance,
    fit_springs,
    on_guide,
    on_slider,
    spring_torques,
)

side = np.linspace(-0.15, 0.15, 41)
poses = xy_grid(side, side, 0.2, -0.5).poses()
places = {
    "zero free length, mast on slider 8": SpringPlace(on_slider(0.1), at_joint(9)),
    "zero free length, post on the guide": SpringPlace(on_guide(0.05, 0.1), at_joint(9)),
    "ordinary spring, mast on slider 8": SpringPlace(
        on_slider(0.1), at_joint(9), min_free_length=0.1, max_free_length=0.3
    ),
}
gravity = static_torques(APPENDIX_4, poses)[..., :3]
print(f"{'as it is':<38}largest torque {np.abs(gravity).max():.3f} N·m")
weighted = static_torques(balance(APPENDIX_4).after, poses)[..., :3]
print(f"{'counterweights':<38}largest torque {np.abs(weighted).max():.3f} N·m")
for name, place in places.items():
    springs = fit_springs(APPENDIX_4, [place], poses).springs
    held = gravity + spring_torques(APPENDIX_4.geometry, springs, poses)[..., :3]
    print(
        f"{name:<38}largest torque {np.abs(held).max():.3f} N·m "
        f"with {springs[0].stiffness:.1f} N/m, {1e3 * springs[0].free_length:.0f} mm"
    )
