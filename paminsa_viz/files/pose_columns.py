"""Columns of a table of poses and of its results, with their units in their names."""

from __future__ import annotations

import difflib

from paminsa_viz.files.errors import TableFileError, printable

POSE = ("x_m", "y_m", "theta_rad", "z_m")
VELOCITY = ("vx_m_s", "vy_m_s", "omega_rad_s", "vz_m_s")
ACCELERATION = ("ax_m_s2", "ay_m_s2", "alpha_rad_s2", "az_m_s2")
GROUPS = {"pose": POSE, "velocity": VELOCITY, "acceleration": ACCELERATION}
INPUTS = POSE + VELOCITY + ACCELERATION
ACTUATORS = ("theta1_rad", "theta2_rad", "theta3_rad", "Z_m")
TORQUES = ("tau1_Nm", "tau2_Nm", "tau3_Nm", "f4_N")
RESULTS = ACTUATORS + TORQUES
STATUS = "status"


def check_columns(columns: tuple[str, ...], source: str) -> None:
    """Check the header of a table of poses.

    Raises:
        TableFileError: If a column is unknown, without a name, there twice, or missing.
    """

    def refuse(problem: str, column: str = "") -> TableFileError:
        return TableFileError(source, problem, row=1, column=column)

    for place, name in enumerate(columns, 1):
        if not name:
            raise refuse(f"column {place} has no name")
        if name not in INPUTS:
            raise refuse(f"there is no such column; {_column_hint(name, columns)}", name)
        if columns.index(name) < place - 1:
            raise refuse("the column is there twice", name)
    for group, names in GROUPS.items():
        absent = [name for name in names if name not in columns]
        if absent and (group == "pose" or len(absent) < len(names)):
            needed = "a pose needs" if group == "pose" else f"with {group} columns come"
            raise refuse(f"the column is missing; {needed} {','.join(names)}", absent[0])


def _column_hint(name: str, columns: tuple[str, ...]) -> str:
    if len(columns) == 1 and (";" in name or "\t" in name):
        return "columns are separated by commas (and decimals written with a point)"
    if _is_number(name):
        return f"the first row has to name the columns: {','.join(POSE)}"
    near = difflib.get_close_matches(printable(name[:50]), INPUTS, 1, 0.5)
    lower = [word for word in INPUTS if word.lower() == name.lower() and word not in columns]
    if name in (*RESULTS, STATUS) and not lower:
        return "it is a result, which is computed and not read; remove it"
    if near or lower:
        return f"did you mean {(lower or near)[0]}?"
    return f"there are {','.join(INPUTS)}"


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True
