"""What the elasticity of bars, drives and joints does: stiffness, deflection, shares of the parts.

`leg_frame` says where a leg is; `beams` and `leg_model` are its elements and joints; `structure`
assembles them. `leg_compliance` finds the same by the force method, fast enough for maps, and
`stiffness` puts three legs together at the platform; `drive_stiffness` has rigid bars.
"""
