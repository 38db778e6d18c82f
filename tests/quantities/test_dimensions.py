"""Every registered number has the dimension of its unit.

Other units of mass, length and time change a number by their powers in its unit and by nothing
else: a constant in a formula that belongs to one size of robot, or a wrong unit, is found.
"""

from __future__ import annotations

import re
from dataclasses import fields, is_dataclass, replace
from functools import cache
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from paminsa_viz.model import (
    APPENDIX_4,
    Counterweight,
    Design,
    Drive,
    KneeBranch,
    LoadCase,
    Payload,
    solve_field,
    xy_grid,
)
from paminsa_viz.quantities import QUANTITIES
from paminsa_viz.studies import METRICS, Region, measure_design
from paminsa_viz.units import si_unit
from tests.support.measured import CLEARANCES

DIMENSIONS = {
    "kg": (1, 0, 0), "m": (0, 1, 0), "s": (0, 0, 1), "N": (1, 1, -2), "Pa": (1, -1, -2),
    "Hz": (0, 0, -1), "rad": (0, 0, 0), "1": (0, 0, 0),
}  # fmt: skip
"""Powers of mass, length and time."""

MOTOR = Drive(
    rotor_inertia=1e-5, gear_ratio=100.0, rated_torque=0.2, peak_torque=0.6, top_speed=400.0
)
SCREW = replace(MOTOR, gear_ratio=2.0, transmission="screw", lead=0.005, rated_torque=1.0)
ROBOT = replace(
    APPENDIX_4,
    drives=(MOTOR, MOTOR, MOTOR, SCREW),
    payload=Payload(3.0, 0.02, 0.1),
    load=LoadCase(10.0, -20.0, -30.0, 2.0, 3.0, 1.0, 0.01, 0.02, 0.03),
    counterweights=(Counterweight("b3", 7, 0.05, 0.5),),
).vary(
    {
        "leg1.bar_94": 1e-3,
        "leg2.joint_angle": 2e-3,
        "elastic.bearing_radial": 1e8,
        "elastic.bearing_tilt": 1e4,
        "elastic.guide": 1e8,
        "accuracy.backlash_rotary": 1e-4,
    }
)
"""A robot with something of all that has a dimension, but for friction, which no quantity has."""

MAPPED = {key: item for key, item in QUANTITIES.items() if item.family != "clearance"}
"""Bodies are drawn with bearings, pins and plates of one size for all robots."""


def power(unit: str, scales: Any) -> float:
    """Return by what a number with a unit changes."""
    above, _, below = unit.partition("/")
    factor = 1.0
    for part, sign in ((above, 1), (below, -1)):
        for symbol in part.split():
            name, _, exponent = symbol.partition("^")
            factor *= float(
                np.prod(scales ** (sign * int(exponent or 1) * np.array(DIMENSIONS[name])))
            )
    return factor


def changed(owner: Any, scales: Any) -> Any:
    """Return a design, or a part of it, in other units."""
    if isinstance(owner, tuple):
        return tuple(changed(item, scales) for item in owner)
    found = {}
    for item in fields(owner) if is_dataclass(owner) else ():
        value, unit = getattr(owner, item.name), item.metadata.get("unit")
        if unit is None:
            found[item.name] = changed(value, scales)
        elif value is not None and "," not in unit:
            found[item.name] = value * power(unit, scales)
    return replace(owner, **found) if found else owner


def numbers(design: Design, length: float) -> dict[str, tuple[str, Any]]:
    """Return everything that is registered, by name, with its unit."""
    axis = np.array([-0.11, 0.02, 0.09]) * length
    field = solve_field(design.geometry, xy_grid(axis, axis, 0.3, -0.6 * length))
    found = {key: (si_unit(item.unit), item.over(field, design)) for key, item in MAPPED.items()}
    region = Region(0.1 * length, (0.0, 0.5), (-0.6 * length,), cells=4)
    values = measure_design(design, region)
    return found | {m.name: (m.unit, v) for m, v in zip(METRICS, values, strict=True)}


@cache
def before(knee: KneeBranch) -> dict[str, tuple[str, Any]]:
    """Return everything that is registered in SI units."""
    return numbers(ROBOT.with_knee(knee), 1.0)


@pytest.mark.slow
@settings(max_examples=3)
@given(st.tuples(*[st.floats(0.5, 2.0)] * 3), st.sampled_from(KneeBranch))
def test_numbers_change_as_their_units_do(powers: tuple[float, ...], knee: KneeBranch) -> None:
    scales = np.array(powers)
    after = numbers(changed(ROBOT.with_knee(knee), scales), powers[1])
    for name, (unit, value) in before(knee).items():
        expected = np.asarray(value) * power(unit, scales)
        assert np.isfinite(expected).any(), name
        largest = np.nanmax(np.abs(expected))
        np.testing.assert_allclose(after[name][1], expected, 1e-9, 1e-9 * largest, err_msg=name)


def test_units_that_no_dimension_tells() -> None:
    """Angles, counts a second, what is shown in another unit; clearances, which are not scaled."""
    angles = [f"pressure_{leg}" for leg in (1, 2, 3)]
    errors = ("error", "linear_error", "rms_error", "tolerance", "rms_tolerance", "deviation")
    places = [f"{kind}_{place}" for kind in errors for place in ("x", "y", "horizontal", "z")]
    turns = [*(f"{kind}_theta" for kind in errors), *(f"{kind}_tilt" for kind in errors[3:])]
    assert {
        key: item.unit
        for key, item in QUANTITIES.items()
        if re.search("rad|Hz|:", item.unit) or item.family == "clearance"
    } == {
        **dict.fromkeys((*angles, "deflection_tilt"), "rad"),
        **dict.fromkeys(("stiffness_theta", "stiffness_tilt"), "N m/rad"),
        **dict.fromkeys(("frequency_1", "frequency_drives"), "Hz"),
        "turn_speed": "rad/s",
        "turn_acceleration": "rad/s^2",
        **dict.fromkeys(places, "m:um"),
        **dict.fromkeys(turns, "rad:arcsec"),
        **dict.fromkeys(("clearance", *(f"clearance_{key}" for key in CLEARANCES)), "m"),
    }
