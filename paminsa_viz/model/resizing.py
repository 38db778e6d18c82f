"""Robots of other lengths whose bars keep their cross section: masses and inertias follow."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from paminsa_viz.model.arrays import Array
from paminsa_viz.model.design import Design, Geometry
from paminsa_viz.model.leg_points import bar_length, counterweight_point
from paminsa_viz.model.lumped import MASS_PATHS, lumped_of_masses, mass_vector, point_mass_column

TUBES = ("b3", "b4", "b7", "b8")
"""Bars whose mass may follow their length."""


def _powers() -> dict[str, int]:
    """Return the power of its bar's length with which each mass and inertia grows."""
    found = {"links.b1": 1, "links.b10": 1, "inertias.b10_vertical": 3}
    for bar in TUBES:
        found |= {f"links.{bar}": 1, f"inertias.{bar}_axial": 1, f"inertias.{bar}_transverse": 3}
    return found


POWERS = _powers()


def _bar(path: str) -> str:
    return path.partition(".")[2].partition("_")[0]


def _length(geometry: Geometry, bar: str) -> float:
    others = {"b1": geometry.arm_length, "b10": geometry.guide_link_length}
    return others[bar] if bar in others else bar_length(geometry, bar)


def _ratio(after: Geometry, before: Geometry, bar: str) -> float:
    """Return how much longer a bar is; 1 if it had no length."""
    length = _length(before, bar)
    return _length(after, bar) / length if length else 1.0


def resized(design: Design, values: Mapping[str, float], *, scale_bars: bool = True) -> Design:
    """Return the design with other lengths.

    Args:
        design: The design.
        values: Lengths by path.
        scale_bars: Whether the bars B3, B4, B7, B8, the arm B1 and the guide link B10 keep their
            cross section: mass and axial inertia grow with the length, transverse inertia with its
            cube.

    Raises:
        InvalidDesign: If the lengths make no robot.
    """
    changed = design.vary(dict(values))
    if not scale_bars:
        return changed
    before, after = design.geometry, changed.geometry
    numbers: dict[str, float | None] = {
        path: _ratio(after, before, _bar(path)) ** power * design.value(path)
        for path, power in POWERS.items()
    }  # fmt: skip
    return changed.vary(numbers)


def resized_masses(design: Design, geometries: Sequence[Geometry], *, scale_bars: bool) -> Array:
    """Return the masses of the design with other geometries, (n, 28), as `resized` has them.

    In the order of `lumped.MASS_PATHS` [kg, kg m^2].
    """
    masses = np.tile(mass_vector(design), (len(geometries), 1))
    if scale_bars:
        ratio = {
            bar: np.array([_ratio(g, design.geometry, bar) for g in geometries])
            for bar in (*TUBES, "b1", "b10")
        }
        for path, power in POWERS.items():
            masses[:, MASS_PATHS.index(path)] *= ratio[_bar(path)] ** power
    return masses


def resized_coefficients(design: Design, geometries: Sequence[Geometry], masses: Array) -> Array:
    """Return the lumped coefficients of the design with other geometries and masses, (n, 18).

    For many robots at once what `lumped.lumped_coefficients` is for one; counterweights keep their
    places on the bars.
    """
    c = lumped_of_masses(geometries, design.gravity, masses)
    for weight in design.counterweights:
        for row, geometry in zip(c, geometries, strict=True):
            point = counterweight_point(geometry, weight)
            row += weight.mass * point_mass_column(point, design.gravity)
    return c
