"""Springs against gravity: what was fitted, and what the actuators hold with them."""

from __future__ import annotations

from paminsa_viz.balancing import SpringFit
from paminsa_viz.blocks.kinds import Note, Table, actuator_rows, heading, rows
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.drive import ACTUATORS, TORQUE_UNITS
from paminsa_viz.units import fixed, format_value

GAP = 1e-6
"""Gap of a certificate that is not worth a word [N m]."""


def springs_blocks(
    fit: SpringFit, torque: Array, held: Array, decimals: tuple[int, int] = (3, 3)
) -> list[Table | Note]:
    """Return the springs, torques without and with them, and the certificate.

    Args:
        fit: One spring on each leg.
        torque: Static torques at a pose without springs, (4,) [N m, N].
        held: The same with them.
        decimals: Of torques and of forces.
    """
    (spring,), ((low, high),) = fit.springs, fit.reach
    facts = (
        ("Stiffness on each leg", format_value(spring.stiffness, "N/m")),
        ("Free length", format_value(spring.free_length, "m")),
        ("Length in use", f"{format_value(low, 'm', 3)} to {format_value(high, 'm', 3)}"),
    )
    of_torque, of_force = decimals
    largest = (
        heading("Largest on a coarse map", "N m"),
        *(fixed(value, of_torque) for value in (fit.before, fit.after)),
    )
    here = actuator_rows(
        *(
            (
                heading(f"{name} at this pose", unit),
                fixed(without, places),
                fixed(with_them, places),
            )
            for name, unit, places, without, with_them in zip(
                ACTUATORS,
                TORQUE_UNITS,
                (*[of_torque] * 3, of_force),
                torque.tolist(),
                held.tolist(),
                strict=True,
            )
        )
    )
    better = f" by more than {format_value(fit.gap, 'N m', 2)}" if fit.gap > GAP else ""
    claim = (
        "no other stiffness and free length is better"
        if fit.helps
        else "no spring between these points lowers the largest torque"
    )
    return [
        Table(("Spring", ""), rows(*facts)),
        Table(("", "Without", "With springs"), (*rows(largest), *here)),
        Note(f"Certified: {claim}{better}."),
    ]
