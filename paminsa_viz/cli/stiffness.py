"""``paminsa-viz stiffness``: stiffness, deflection and what to stiffen first, at a pose."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Annotated, Any

import numpy as np
import tyro

from paminsa_viz.cli.arguments import UsageError
from paminsa_viz.cli.flags import DesignFlags, JsonFlags, PoseFlags
from paminsa_viz.cli.output import print_blocks, print_json, print_table
from paminsa_viz.elastostatics.beams import TubeFit, tube_fits
from paminsa_viz.elastostatics.drive_stiffness import drive_modes, drive_stiffness
from paminsa_viz.elastostatics.leg_frame import contacts
from paminsa_viz.elastostatics.stiffness import (
    SHARES,
    PlatformStiffness,
    compensate,
    load_wrench,
    platform_stiffness,
)
from paminsa_viz.elastostatics.vibration import robot_modes
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.design import Design
from paminsa_viz.model.drive import ACTUATORS
from paminsa_viz.model.reach import home_pose, require_reachable
from paminsa_viz.report.stiffness_section import stiffness_blocks, strain_cases
from paminsa_viz.units import MM, format_pose

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

KEYS = ("x_N_per_m", "y_N_per_m", "z_N_per_m", "about_x_Nm_per_rad", "about_y_Nm_per_rad",
        "about_z_Nm_per_rad")  # fmt: skip


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
        if reason := found.reason():
            if self.json:
                print_json({"pose": pose.tolist(), "reason": reason})
            else:
                place = format_pose(pose, ascii_only=True)
                print(f"{design.name}, {place}: no compliance; {reason}")
            return 1
        if self.json:
            print_json(_data(design, found, shear=self.shear))
        else:
            print(f"{design.name}, {format_pose(pose, ascii_only=True)}")
            print_blocks(stiffness_blocks(design, found, shear=self.shear))
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


def _data(design: Design, found: PlatformStiffness, *, shear: bool) -> dict[str, Any]:
    moved = compensate(design, found.pose, shear=shear)
    axes, directions = found.ellipsoid()
    alone = drive_stiffness(design, found.pose)
    return {
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
            for name, share in strain_cases(design, found.pose, shear=shear).items()
        },
    }


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
