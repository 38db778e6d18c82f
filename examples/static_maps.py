"""Torque maps like the paper's Fig. 3: what M1, M2 and M3 hold at theta = 60 degrees, at rest.

Gravity's torque on the rotary actuators is one number of the masses, M_p2, times a map that the
lengths alone decide: Q_j(x, y, theta, z) = M_p2 Gamma_j(x, y, theta, z). So the workspace is solved
once, and another robot with the same lengths costs a multiplication.
"""

from pathlib import Path

import numpy as np

from paminsa_viz.model import APPENDIX_4, Limit, solve_field, static_imbalance, xy_grid
from paminsa_viz.plots import choose_scales, map_data, render_maps

THETA, Z = np.pi / 3, -0.5  # the paper does not say the height of its figure

side = np.linspace(-0.42, 0.42, 169)
field = solve_field(APPENDIX_4.geometry, xy_grid(side, side, THETA, Z))
maps = map_data(field, APPENDIX_4, pose=(0.0, 0.0, THETA, Z))
Path("static_maps.png").write_bytes(render_maps(maps, choose_scales(maps), dpi=150))

heavier = APPENDIX_4.vary({"links.b4": 1.5 * APPENDIX_4.links.b4})
for design in (APPENDIX_4, heavier):
    torque = np.abs(field.torques(design)[:3, field.status == Limit.OK])
    print(
        f"m_B4 = {design.links.b4:.3f} kg: M_p2 = {static_imbalance(design):.3f} N, "
        f"half of the torques are below {np.median(torque):.2f} N·m"
    )
print("static_maps.png: written")
