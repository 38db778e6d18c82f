"""Units of every number in blocks: in a scaled robot each changes as its unit says.

Lengths are multiplied by A and masses by B, times stay; so a force, as gravity grows too,
is multiplied by A·B, a torque by A²·B, an angle by one. Every text of the blocks is then the same
but for its numbers, and each of these is the one before, times what its unit alone says: a heading
with a wrong unit, or a value in another one, does not scale.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterator, Sequence
from dataclasses import fields, replace
from functools import cache
from itertools import zip_longest

import numpy as np
import pytest

from paminsa_viz.balancing import balance
from paminsa_viz.blocks import forces
from paminsa_viz.blocks.accuracy import drive_blocks, manufacture_blocks
from paminsa_viz.blocks.balance import balance_blocks, optimum_blocks
from paminsa_viz.blocks.design import design_blocks
from paminsa_viz.blocks.drives import drives_blocks
from paminsa_viz.blocks.forces import forces_blocks
from paminsa_viz.blocks.kinds import Block, Note, Table
from paminsa_viz.blocks.loads import loads_blocks
from paminsa_viz.blocks.maps import maps_blocks, maps_data
from paminsa_viz.blocks.requirements import check_blocks
from paminsa_viz.blocks.stiffness import robot_blocks, sections_table
from paminsa_viz.blocks.trajectory import simulation_notes, trajectory_blocks
from paminsa_viz.elastostatics.beams import tube_fits
from paminsa_viz.model.design import APPENDIX_4, PARAMETER, Design
from paminsa_viz.model.drive import Drive
from paminsa_viz.plots.map_values import map_data, workspace_field
from paminsa_viz.precision.drive_errors import drive_errors
from paminsa_viz.quantities import TORQUES
from paminsa_viz.quantities.requirements import Requirement, Requirements, Workspace, WorkspaceShape
from paminsa_viz.studies.region import Region, RegionResults, default_region
from paminsa_viz.synthesis.volume.check import check_requirements
from paminsa_viz.synthesis.volume.grid import Resolution
from paminsa_viz.synthesis.volume.solve import solve_volume
from paminsa_viz.trajectory import PRESET, Trajectory, analyze, simulate

A, B = 2.0, 3.0
"""Scales of lengths and of masses."""

POSE = (0.03, -0.02, 0.25, -0.52)

SCALES = {
    "m": A, "kg": B, "N": A * B, "W": A**2 * B, "J": A**2 * B, "Pa": B / A, "s": 1.0, "rad": 1.0,
    "Hz": 1.0, "°": 1.0, "″": 1.0, "%": 1.0, "rpm": 1.0, "mrad": 1.0,
    "mm": A, "µm": A, "dm": A, "MPa": B / A,
}  # fmt: skip
"""What a unit is multiplied by."""

SERVO = Drive(
    "servo", 4e-6, gear_ratio=80.0, efficiency=0.8, rated_torque=0.3, peak_torque=0.9,
    top_speed=600.0, thermal_time_constant=300.0, viscous=1e-5,
)  # fmt: skip
SCREW = replace(SERVO, gear_ratio=1.0, transmission="screw", lead=0.02, peak_torque=1.5)


def scale(unit: str) -> float:
    """Return what a value with a unit is multiplied by, such as ``kg m^2`` or ``N·m·s/rad``."""
    above, *below = unit.partition(":")[0].translate(str.maketrans("²³⁴", "234")).split("/")
    found = 1.0
    for part, sign in [(above, 1), *((part, -1) for part in below)]:
        for name, power in re.findall(r"([^\W\d_]+|[°″%])\^?(\d?)", part):
            found *= SCALES[name] ** (sign * int(power or 1))
    return found


def scaled(design: Design) -> Design:
    """Return a design with lengths and masses multiplied."""
    larger = design.vary(
        {
            path: design.value(path) * scale(item.unit)
            for path, item in PARAMETER.items()
            if math.isfinite(design.value(path))
        }
    )
    weights = [
        replace(one, mass=B * one.mass, beyond=A * one.beyond) for one in design.counterweights
    ]
    drives = tuple(one and _scaled_drive(one) for one in design.drives)
    return replace(larger, drives=drives, counterweights=tuple(weights))


def _scaled_drive(drive: Drive) -> Drive:
    values = {
        item.name: getattr(drive, item.name) * scale(item.metadata.get("unit", ""))
        for item in fields(drive)
        if isinstance(getattr(drive, item.name), float)
    }
    return replace(drive, **values)


def scaled_motion(motion: Trajectory) -> Trajectory:
    size = np.array([A, A, 1.0, A])
    states = {name: size * getattr(motion, name) for name in ("pose", "velocity", "acceleration")}
    return replace(motion, **states)


UNIT = (
    r"\s?[°″%](?:/s²?)?|\s(?:1/m|[mM]Pa|[µmd]?m[²³⁴]?|kg|N|W|J|Hz|rpm|m?rad)"
    r"(?:(?:[·/]| (?=m\b))(?:mm|m|s|rad|N)[²³]?)*(?!\w)"
)
NUMBER = re.compile(
    r"(?P<number>[+−-]?(?<![\w.])\d[\d,]*(?:\.\d+)?(?:·10[⁻⁰¹²³⁴⁵⁶⁷⁸⁹]+)?)"
    rf"(?![\w.]*\w_)(?P<unit>{UNIT})?"
)
SHARED = re.compile(rf"(\d[\d.]*)(?=(?:(?: ×| ±|,|/) ?[−-]?[\d.]+)+(?P<unit>{UNIT}))")
"""Numbers that have the unit of the last one: ``200 × 100 mm``, ``50/25.1 mm``, ``1, 2, 3 N m``."""


def value(text: str) -> tuple[float, float]:
    """Return a number as it is printed, and half a unit of its last digit."""
    mantissa, _, power = text.replace(",", "").replace("−", "-").partition("·10")
    exponent = int(power.translate(str.maketrans("⁻⁰¹²³⁴⁵⁶⁷⁸⁹", "-0123456789"))) if power else 0
    _, _, decimals = mantissa.partition(".")
    size = abs(float(mantissa))
    last = max(10.0 ** -len(decimals), 10.0 ** (math.floor(math.log10(size)) - 3) if size else 0.0)
    return float(mantissa) * 10.0**exponent, 0.5 * last * 10.0**exponent


def _with_units(text: str) -> str:
    return SHARED.sub(r"\1\g<unit>", text)


def texts(blocks: Sequence[Block]) -> Iterator[tuple[str, str]]:
    """Yield the texts of blocks, each with the unit of its column or, without, of its row."""
    for block in blocks:
        if isinstance(block, Note):
            yield _with_units(block.text), ""
        if isinstance(block, Table):
            yield block.caption, ""
            of_all = re.fullmatch(r"\[(.*)\]", block.head[0])
            for row in block.rows:
                cells = dict(zip_longest(block.head, row.cells, fillvalue=""))
                pairs = zip_longest(block.head, row.cells, fillvalue="")
                for place, (head, cell) in enumerate(pairs):
                    unit = of_all[1] if of_all else cells.get("Unit", "")
                    unit = unit or _unit_in(head)
                    if place >= block.words:  # no unit for the numbers in its words
                        unit = unit or _unit_in(row.cells[0])
                    yield _with_units(cell), unit


def _unit_in(heading: str) -> str:
    """Return the unit that the heading of a column or a row has."""
    named = re.search(r"\[(.*?)\]|^(kg|W)$", heading)
    return (named[1] or named[2]) if named else ""


def check(before: Sequence[Block], after: Sequence[Block], slack: float = 0.0) -> int:
    """Compare the blocks of a robot and of the scaled one; return how many numbers scaled.

    Signs are left out: of two extremes of the same size either may be named.
    """
    changed = 0
    for (one, column), (other, _) in zip(texts(before), texts(after), strict=True):
        assert NUMBER.sub(r"#\g<unit>", one) == NUMBER.sub(r"#\g<unit>", other)
        for first, second in zip(NUMBER.finditer(one), NUMBER.finditer(other), strict=True):
            factor = scale((first["unit"] or column).strip())
            (old, off), (new, off_new) = value(first["number"]), value(second["number"])
            rounding = 1.01 * (factor * off + off_new) + slack * abs(new)
            assert abs(abs(new) - factor * abs(old)) <= rounding, (one, other, column)
            changed += factor != 1.0 and old != 0.0
    return changed


@cache
def robot() -> tuple[Design, Trajectory]:
    design = APPENDIX_4.vary(
        {
            "payload.mass": 1.5, "load.force_x": 4.0, "friction.viscous_rotary": 0.2,
            "accuracy.backlash_linear": 5e-6,
        }
    )  # fmt: skip
    design = replace(design, drives=(SERVO, SERVO, SERVO, SCREW))
    return design, PRESET["arch"].build(design.geometry).sample(100)


def trajectory(design: Design, motion: Trajectory, pose: np.ndarray, size: float) -> list[Block]:
    return trajectory_blocks(analyze(design, motion, clearance=0.005 * size))


def simulation(design: Design, motion: Trajectory, pose: np.ndarray, size: float) -> list[Block]:
    """Driven with a third more payload than the controller knows of."""
    heavier = design.vary({"payload.mass": 4.0 / 3.0 * design.payload.mass})
    return list(simulation_notes(simulate(heavier, motion, model=design))[:1])


def balancing(design: Design, motion: Trajectory, pose: np.ndarray, size: float) -> list[Block]:
    return [*balance_blocks(analyze(design, motion)), *optimum_blocks(balance(design))[:1]]


def accuracy(design: Design, motion: Trajectory, pose: np.ndarray, size: float) -> list[Block]:
    here = drive_errors(design.geometry, design.accuracy, pose)
    over = RegionResults(design, default_region(design))
    return [*drive_blocks(here, over), *manufacture_blocks(design, pose)]


def maps(design: Design, motion: Trajectory, pose: np.ndarray, size: float) -> list[Block]:
    field = workspace_field(design.geometry, pose[2], pose[3], 30, 0.2 * size)
    data = map_data(field, design, pose, TORQUES)
    found = maps_blocks(data, maps_data(data, TORQUES, 10.0))
    return [one for one in found if not (isinstance(one, Note) and "cells that count" in one.text)]


def requirements(design: Design, motion: Trajectory, pose: np.ndarray, size: float) -> list[Block]:
    mass = B if size == A else 1.0
    bounds = (
        Requirement("condition", high=10.0),
        Requirement("max_torque", high=15.0 * size**2 * mass),
    )
    place = Workspace(
        WorkspaceShape.CYLINDER, (0.2 * size, 0.2 * size, 0.1 * size), (0.0, 0.0, -0.55 * size)
    )
    asked = Requirements(bounds, (-0.1, 0.1), place)
    volume = solve_volume(design, asked, resolution=Resolution(2000, 3, 60.0))
    return check_blocks(asked, check_requirements(design, asked, fine=False, volume=volume))


def values(design: Design, motion: Trajectory, pose: np.ndarray, size: float) -> list[Block]:
    """Without what compares them with Appendix 4; scaled, so that none of them is its own.

    The speed at which friction sets in is one number with two units, and left out.
    """
    tables = [block for block in design_blocks(scaled(design)) if isinstance(block, Table)]
    return [
        replace(
            one,
            rows=tuple(
                replace(row, cells=row.cells[:3])
                for row in one.rows
                if not any(cell.endswith("rad/s, m/s") for cell in row.cells)
            ),
        )
        for one in tables
    ]


SUBJECTS: dict[str, Callable[[Design, Trajectory, np.ndarray, float], Sequence[Block]]] = {
    "trajectory": trajectory,
    "simulation": simulation,
    "balance": balancing,
    "accuracy": accuracy,
    "maps": maps,
    "requirements": requirements,
    "design": values,
    "drives": lambda design, motion, pose, size: drives_blocks(analyze(design, motion)),
    "forces": lambda design, motion, pose, size: forces_blocks(design, pose),
    "loads": lambda design, motion, pose, size: loads_blocks(
        analyze(design, motion), pose.tolist()
    ),
    "stiffness": lambda design, motion, pose, size: robot_blocks(design, pose),
    "sections": lambda design, motion, pose, size: [sections_table(design, tube_fits(design))],
}


COUNTED = {"forces": 2e-3, "stiffness": 2e-3}
"""Subjects with indices over poses that count, 10 mm from a stretched leg in every robot: what
others change, in parts."""


def coarse_region(design: Design) -> Region:
    """The default region in few cells."""
    return replace(default_region(design), cells=10)


@pytest.mark.slow
@pytest.mark.parametrize("subject", SUBJECTS)
def test_numbers_scale_as_their_units_say(subject: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(forces, "default_region", coarse_region)
    design, motion = robot()
    pose = np.array(POSE)
    before = SUBJECTS[subject](design, motion, pose, 1.0)
    larger = np.array([A, A, 1.0, A]) * pose
    after = SUBJECTS[subject](scaled(design), scaled_motion(motion), larger, A)
    assert check(before, after, COUNTED.get(subject, 0.0)) >= 3
