"""``paminsa-viz stiffness``: stiffness, deflection and what to stiffen first, at a pose."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Annotated, Any

import numpy as np
import tyro

from paminsa_viz import __version__
from paminsa_viz.cli.arguments import UsageError
from paminsa_viz.cli.flags import DesignFlags, JsonFlags, PoseFlags
from paminsa_viz.cli.output import print_json, print_table
from paminsa_viz.elastostatics.contacts import contacts
from paminsa_viz.elastostatics.drive_modes import drive_modes
from paminsa_viz.elastostatics.drive_stiffness import drive_stiffness
from paminsa_viz.elastostatics.sections import TubeFit, tube_fits
from paminsa_viz.elastostatics.stiffness import (
    SHARES,
    Compensation,
    PlatformStiffness,
    compensate,
    load_wrench,
    platform_stiffness,
    strain_shares,
)
from paminsa_viz.elastostatics.vibration import robot_modes
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.design import Design
from paminsa_viz.model.drive import ACTUATORS
from paminsa_viz.model.reach import Limit, home_pose, require_reachable
from paminsa_viz.units import DEGREES, MM, format_ascii

DESCRIPTION = """\
Stiffness of the robot at a pose, motors locked: 6x6 at the platform's center, deflection under
payload and load, the share of each part, what the motors can bring back, natural frequencies.

  paminsa-viz stiffness --payload 10                    half a millimeter under 10 kg
  paminsa-viz stiffness --pose 50 20 30 -600 --load 20 0 0 0 0 0
  paminsa-viz stiffness --design stiff.toml --shear --json
  paminsa-viz stiffness --sections                      tubes beside the masses and inertias

Bars bend, stretch, twist and, with --shear, shear; drives are springs; joints and guides are rigid
unless the design file's [elastic] table says otherwise. The defaults of that table are chosen and
not measured: give the sections of your own bars. See docs/stiffness.md.

Exit code: 0 done; 1 the pose is singular, where nothing has a compliance; 2 a wrong argument or
file, or a pose out of reach."""

NAMES = ("x", "y", "z", "about x", "about y", "about z")
KEYS = ("x_N_per_m", "y_N_per_m", "z_N_per_m", "about_x_Nm_per_rad", "about_y_Nm_per_rad",
        "about_z_Nm_per_rad")  # fmt: skip
UNITS = ("N/m",) * 3 + ("N m/rad",) * 3
ACTUATED = (0, 1, 5, 2)
"""x, y, theta, z in a twist."""


@dataclass(frozen=True, kw_only=True)
class Stiffness(JsonFlags, PoseFlags, DesignFlags):
    """Flags of the command."""

    payload: Annotated[float | None, tyro.conf.arg(metavar="KG")] = None
    """Payload [kg] with its center at the platform's, instead of the design's own."""
    shear: bool = False
    """Bars deform by shear as well (Timoshenko)."""
    sections: bool = False
    """Print the tubes of the bars beside the design's masses and inertias instead."""

    def run(self) -> int:
        """Compute and report."""
        design = self.given_design()
        if self.payload is not None:
            design = replace(design, payload=replace(design.payload, mass=self.payload))
        if self.sections:
            if self.pose is not None:
                raise UsageError("--sections excludes --pose: the tubes are the same everywhere")
            return self._print_sections(design)
        pose = np.array(self.given_pose or home_pose(design.geometry))
        require_reachable(design.geometry, pose)
        found = platform_stiffness(design, pose, shear=self.shear)
        if found.status != Limit.OK:
            reason = Limit(int(found.status)).reason(int(found.leg))
            if self.json:
                print_json({"pose": pose.tolist(), "reason": reason})
            else:
                print(f"{design.name}, {_pose(pose)}: no compliance; {reason}")
            return 1
        loaded = bool(np.any(load_wrench(design, pose)))
        moved = compensate(design, pose, shear=self.shear)
        if self.json:
            print_json(_data(design, found, moved, loaded, shear=self.shear))
        else:
            _print(design, found, moved, loaded, shear=self.shear)
        return 0

    def _print_sections(self, design: Design) -> int:
        fits = tube_fits(design)
        if self.json:
            print_json({"design": design.name, "bars": [fit._asdict() for fit in fits]})
            return 0
        print(f"{design.name}: tubes of [elastic], and the links' masses and inertias over theirs")
        rows = [("", "tube", "mass", "link/tube", "I_YY/(m l^2/12)", "I_YY/tube", "I_XX/tube")]
        rows += [_section_row(design, fit) for fit in fits]
        print_table(rows, words=1)
        return 0


FLAGS = Stiffness


def _section_row(design: Design, fit: TubeFit) -> tuple[str, ...]:
    outer, inner = (
        MM * design.value(f"elastic.{fit.bar.lower()}_{side}") for side in ("outer", "inner")
    )
    ratios = (fit.mass_ratio, fit.slender_ratio, fit.transverse_ratio, fit.axial_ratio)
    mass, *inertias = (f"{ratio:.3g}" for ratio in ratios)
    return (fit.bar, f"{outer:g}/{inner:g} mm", f"{fit.mass:.3f} kg", mass, *inertias)


def _rounded(values: Array) -> Array:
    """Return values with zeros for what is rounding beside the largest."""
    return np.where(np.abs(values) < 1e-9 * np.abs(values).max(), 0.0, values)


def _pose(pose: Array) -> str:
    x, y, theta, z = pose
    return f"x {MM * x:g}, y {MM * y:g}, z {MM * z:g} mm, theta {DEGREES * theta:g} deg"


def _shares(design: Design, pose: Array, loaded: bool, shear: bool) -> dict[str, Array]:
    """Return the shares of the parts under the load, or under unit forces where there is none."""
    if loaded:
        return {"load": strain_shares(design, pose, shear=shear).share}
    units = {"force x": 0, "force y": 1, "force z": 2, "moment z": 5}
    return {
        name: strain_shares(design, pose, np.eye(6)[axis], shear=shear).share
        for name, axis in units.items()
    }


def _data(
    design: Design, found: PlatformStiffness, moved: Compensation, loaded: bool, *, shear: bool
) -> dict[str, Any]:
    axes, directions = found.ellipsoid()
    alone = drive_stiffness(design, found.pose)
    return {
        "made_by": f"paminsa_viz {__version__}",
        "design": design.name,
        "pose": found.pose.tolist(),
        "shear": shear,
        "stiffness": {key: float(found.along(i)) for i, key in enumerate(KEYS)}
        | {"horizontal_N_per_m": float(found.horizontal), "tilt_Nm_per_rad": float(found.tilt)},
        "matrix": found.matrix.tolist(),
        "drives_alone": alone.tolist(),
        "ellipsoid": {"axes_m_per_N": axes.tolist(), "directions": directions.T.tolist()},
        "wrench": load_wrench(design, found.pose).tolist(),
        "deflection": moved.deflection.tolist(),
        "compensation": dict(zip(ACTUATORS, moved.actuators.tolist(), strict=True)),
        "residual_tilt_rad": float(moved.tilt),
        "contacts": contacts(design, found.pose).touching(),
        "natural_frequencies_Hz": _frequencies(design, found.pose, shear=shear),
        "shares": {
            name: dict(zip(SHARES, share.tolist(), strict=True))
            for name, share in _shares(design, found.pose, loaded, shear).items()
        },
    }


def _print(
    design: Design, found: PlatformStiffness, moved: Compensation, loaded: bool, *, shear: bool
) -> None:
    print(f"{design.name}, {_pose(found.pose)}")
    alone = np.linalg.inv(drive_stiffness(design, found.pose))
    rows = [("stiffness", "whole robot", "drives alone")]
    for axis, (name, unit) in enumerate(zip(NAMES, UNITS, strict=True)):
        rigid = "rigid"
        if axis in ACTUATED:
            place = ACTUATED.index(axis)
            rigid = format_ascii(float(1 / alone[place, place]), unit, 3)
        rows.append((name, format_ascii(float(found.along(axis)), unit, 3), rigid))
    rows.append(("softest horizontal", format_ascii(float(found.horizontal), "N/m", 3), ""))
    rows.append(("softest tilt", format_ascii(float(found.tilt), "N m/rad", 3), ""))
    print_table(rows, words=1)
    axes, directions = found.ellipsoid()
    softest = " ".join(f"{value:.2f}" for value in directions[:, -1])
    if touching := contacts(design, found.pose).touching():
        print(f"center lines in one plane: {', '.join(touching)} would touch and are let through")
    print(f"compliance ellipsoid: {' '.join(f'{MM * a:.3g}' for a in axes)} mm/N, "
          f"softest along ({softest})")  # fmt: skip
    print()
    shares = _shares(design, found.pose, loaded, shear)
    if loaded:
        _print_deflection(design, found, moved)
    _print_frequencies(_frequencies(design, found.pose, shear=shear))
    print("share of the strain energy:")
    order = sorted(range(len(SHARES)), key=lambda i: -max(share[i] for share in shares.values()))
    rows = [("", *shares)]
    for i in order:
        if any(share[i] > 0 for share in shares.values()):
            rows.append((SHARES[i], *(f"{100 * share[i]:.1f} %" for share in shares.values())))
    print_table(rows, words=1)


def _frequencies(design: Design, pose: Array, *, shear: bool) -> dict[str, list[float | None]]:
    """Return natural frequencies, lowest first [Hz]; None where loads push the platform away."""
    every = {
        "whole robot": robot_modes(design, pose, shear=shear).frequencies,
        "drives alone": drive_modes(design, pose).frequencies,
    }
    return {
        name: [float(value) if np.isfinite(value) else None for value in values]
        for name, values in every.items()
    }


def _print_frequencies(frequencies: dict[str, list[float | None]]) -> None:
    for name, values in frequencies.items():
        texts = ["-" if value is None else f"{value:.3g}" for value in values]
        print(f"natural frequencies, {name}: {', '.join(texts)} Hz")
    print()


def _print_deflection(design: Design, found: PlatformStiffness, moved: Compensation) -> None:
    wrench = load_wrench(design, found.pose)
    twist, actuators = _rounded(moved.deflection), _rounded(moved.actuators)
    units = ("N",) * 3 + ("N m",) * 3
    rows = [("", "load", "deflection")]
    for name, load, unit, value, of in zip(
        NAMES, wrench, units, twist, ("m",) * 3 + ("rad",) * 3, strict=True
    ):
        rows.append((name, format_ascii(load, unit), format_ascii(value, of, 3)))
    print_table(rows, words=1)
    back = ", ".join(
        f"{name} {format_ascii(value, 'm' if name == 'M4' else 'rad', 3)}"
        for name, value in zip(ACTUATORS, actuators, strict=True)
    )
    print(f"compensation: {back}")
    print(f"residual tilt: {format_ascii(float(np.hypot(*twist[3:5])), 'rad', 3)}")
    print()
