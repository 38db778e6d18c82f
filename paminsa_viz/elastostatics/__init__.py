"""Stiffness and natural frequencies: what elastic drives and bars let the platform do.

`stiffness.drive_stiffness(design, pose)`, (..., 4, 4) in (x, y, theta, z), is the stiffness of the
drives alone with locked motors; its mass matrix is the model's without the inertia of the motors,
which stand still. `modes` solves the vibration of both. For the whole robot the coordinates of a
pose are (x, y, z, and turns about x, y, z) of the platform at P.
"""
