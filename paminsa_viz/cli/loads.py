"""``paminsa-viz loads``: forces at the joints and in the bars, at rest or along a motion."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
import tyro

from paminsa_viz import __version__
from paminsa_viz.cli.arguments import UsageError
from paminsa_viz.cli.flags import DesignFlags, JsonFlags, MotionFlags, PoseFlags, check_ending
from paminsa_viz.cli.output import print_error, print_json, print_table, print_written
from paminsa_viz.elastostatics.bar_diagram import COMPONENTS
from paminsa_viz.elastostatics.bar_loads import all_bar_loads, arm_tip
from paminsa_viz.elastostatics.joint_forces import (
    JOINTS,
    NEEDS_STIFFNESS,
    JointForces,
    joint_forces,
)
from paminsa_viz.elastostatics.motion_loads import MotionLoads, motion_loads
from paminsa_viz.elastostatics.sideways import SidewaysForces, sideways_forces
from paminsa_viz.elastostatics.utilization import utilization
from paminsa_viz.errors import PaminsaError
from paminsa_viz.files.atomic import write_bytes
from paminsa_viz.files.loads_table import bar_table, bearing_table, joint_table, motion_loads_table
from paminsa_viz.files.tables import DataTable, table_bytes, table_endings
from paminsa_viz.model.design import Design
from paminsa_viz.model.elastic import BARS
from paminsa_viz.model.reach import Limit, home_pose, require_reachable, status_words
from paminsa_viz.trajectory import ImpossibleTrajectory, analyze

DESCRIPTION = """\
Forces at the joints in the legs' planes, N, V and M of the bars, bearing loads of a motion.

  paminsa-viz loads                                     at rest in the middle of the workspace
  paminsa-viz loads --pose 50 0 10 -500 --load 0 0 -100 0 0 0
  paminsa-viz loads --bar b4 --out b4.csv               N, V and M along B4
  paminsa-viz loads --preset arch --out arch.csv        every sample of a motion
  paminsa-viz loads --preset arch --bearings --out bearings.csv

With --preset or --file it is along that motion: peak, RMS and equivalent load of every bearing.
Without, at rest. Signs and conventions are those of docs/loads.md. Sideways, joints share forces by
the elasticity of the legs; those shares are given at rest, from the design's elastic data.

Exit code: 0 done; 1 the pose is singular, or the robot cannot run the whole motion; 2 a wrong
argument or file, or a pose out of reach."""

PERCENT = 100.0

ROUNDING = 1e-10
"""Force [N] or moment [N m] that is printed as zero."""


@dataclass(frozen=True, kw_only=True)
class Loads(JsonFlags, MotionFlags, PoseFlags, DesignFlags):
    """Flags of the command."""

    bar: Literal["b1", "b2", "b3", "b4", "b7", "b8", "b10"] | None = None
    """Write N, V and M along this bar, at rest."""
    bearings: bool = False
    """Write peak, RMS and equivalent load of every joint instead of the motion's samples."""
    out: Annotated[tuple[Path, ...], tyro.conf.arg(metavar="FILE")] = ()
    """Table to write (.csv, .npz); may be given several times."""

    def run(self) -> int:
        """Compute the loads and report."""
        self._check()
        design = self.given_design()
        if self.preset is not None or self.file is not None:
            return self._motion(design)
        return self._pose(design)

    def _check(self) -> None:
        self.exclude_both()
        for path in self.out:
            check_ending("--out", path, table_endings())
        moving = self.preset is not None or self.file is not None
        for wrong, problem in (
            (moving and self.pose is not None, "--pose excludes --preset and --file"),
            (moving and self.bar is not None, "--bar is at rest and excludes --preset and --file"),
            (not moving and self.bearings, "--bearings needs --preset or --file"),
        ):
            if wrong:
                raise UsageError(f"{problem}; see paminsa-viz loads --help")

    def _write(self, table: DataTable) -> None:
        for path in self.out:
            write_bytes(path, table_bytes(table, path.suffix.lower()[1:]))
        if not self.json:
            print_written(self.out)

    def _pose(self, design: Design) -> int:
        pose = np.array(self.given_pose or home_pose(design.geometry))
        require_reachable(design.geometry, pose)
        forces = joint_forces(design, pose)
        if forces.status != Limit.OK:
            print_error(ImpossiblePose(str(status_words(forces.status, forces.leg))))
            return 1
        sideways = sideways_forces(design, pose)
        if self.json:
            print_json(_pose_data(design, pose, forces, sideways))
        else:
            _print_pose(forces, sideways)
        if self.bar is not None:
            self._write(bar_table(forces, pose, self.bar))
        elif self.out:
            self._write(joint_table(forces, pose, sideways.force))
        return 0

    def _motion(self, design: Design) -> int:
        analysis = analyze(design, self.given_motion(design.geometry))
        found, first = motion_loads(analysis), analysis.check.first
        if found is None:
            if first is not None:
                print_error(ImpossibleTrajectory(first))
            return 1
        if self.json:
            print_json(_motion_data(found))
        else:
            _print_motion(found)
        if self.out:
            self._write(bearing_table(found) if self.bearings else motion_loads_table(found))
        if first is not None:
            print_error(ImpossibleTrajectory(first))
        return 0 if first is None else 1


FLAGS = Loads


class ImpossiblePose(PaminsaError):
    """A pose without forces."""

    def __init__(self, word: str) -> None:
        super().__init__(f"there are no joint forces in this pose: {word}")


def _print_pose(forces: JointForces, sideways: SidewaysForces) -> None:
    head = ("joint", *(f"{part} {leg}" for leg in (1, 2, 3) for part in ("r", "z", "M")))
    rows: list[tuple[str, ...]] = [head]
    for index, joint in enumerate(JOINTS):
        cells = []
        for leg in range(3):
            force = forces.force[leg, index]
            cells += [_number(force[0]), _number(force[2]), _number(forces.moment[leg, index])]
        rows.append((joint.label, *cells))
    print("forces [N] and moments [N m] in the planes of legs 1 to 3, at rest\n")
    print_table(rows, words=1)
    parts = ("w", "M_u", "M_z")
    rows = [("joint", *(f"{part} {leg}" for leg in (1, 2, 3) for part in parts))]
    for index, joint in enumerate(JOINTS):
        cells = []
        for leg in range(3):
            moment = sideways.moment[leg, index]
            cells += [_number(value) for value in (sideways.force[leg, index], *moment)]
        rows.append((joint.label, *cells))
    print("\nacross the planes, shared by elasticity: forces [N], moments [N m] about r and z\n")
    print_table(rows, words=1)
    tau = ", ".join(_number(value) for value in forces.torque[:3])
    print(f"\ntorques {tau} N m, force of M4 {_number(forces.torque[3])} N\n")
    use = utilization(forces)
    rows = [("bar", *(f"{part} {leg}" for leg in (1, 2, 3) for part in (*COMPONENTS, "use")))]
    for number, (bar, loads) in enumerate(all_bar_loads(forces).items()):
        cells = []
        for leg, inner in enumerate(loads.extremes()):
            cells += [_number(value) for value in inner]
            cells.append(f"{PERCENT * use[leg, number]:.2f} %")
        rows.append((bar.upper(), *cells))
    print("largest N [N], V [N], M [N m] along the bars, stress over yield stress\n")
    print_table(rows, words=1)
    tip = arm_tip(forces)
    bending = ", ".join(
        _number(value) for value in (tip.sideways * forces.design.geometry.arm_length).reshape(3)
    )
    torsion = ", ".join(_number(value) for value in tip.torsion.reshape(3))
    print(
        f"\nroots of the arms B1, without sideways shares: horizontal bending {bending} N m, "
        f"torsion {torsion} N m"
    )


def _print_motion(found: MotionLoads) -> None:
    t = found.trajectory
    print(f'motion "{t.name}", {t.t[-1] - t.t[0]:.3g} s: forces [N] at legs 1 to 3\n')
    parts = ("peak", "RMS", "eq.")
    rows = [("joint", *(f"{part} {leg}" for leg in (1, 2, 3) for part in parts))]
    for index, joint in enumerate(JOINTS):
        cells = []
        for leg in range(3):
            values = (found.peak, found.rms, found.equivalent)
            cells += [_number(value[leg, index]) for value in values]
        rows.append((joint.label, *cells))
    print_table(rows, words=1)
    rows = [("bar", *(f"{part} {leg}" for leg in (1, 2, 3) for part in (*COMPONENTS, "use")))]
    use = found.utilization.max(axis=0)
    for number, bar in enumerate(BARS):
        cells = []
        for leg in range(3):
            cells += [_number(value) for value in found.bar_peak[leg, number]]
            cells.append(f"{PERCENT * use[leg, number]:.2f} %")
        rows.append((bar.upper(), *cells))
    print("\nlargest N [N], V [N], M [N m] along the bars, stress over yield stress\n")
    print_table(rows, words=1)


def _number(value: float) -> str:
    if np.isnan(value):
        return "-"
    return "0" if abs(value) < ROUNDING else f"{value:.4g}"


def _pose_data(
    design: Design, pose: Any, forces: JointForces, sideways: SidewaysForces
) -> dict[str, Any]:
    use = utilization(forces)
    return {
        "made_by": f"paminsa_viz {__version__}",
        "design": design.name,
        "pose": pose.tolist(),
        "torque": forces.torque.tolist(),
        "axial_N": float(forces.axial),
        "sideways": NEEDS_STIFFNESS,
        "legs": [
            {
                "joints": {
                    joint.key: {
                        "on": joint.on, "by": joint.by,
                        "force_N": forces.force[leg, index].tolist(),
                        "moment_Nm": float(forces.moment[leg, index]),
                        "sideways_N": float(sideways.force[leg, index]),
                        "sideways_moments_Nm": sideways.moment[leg, index].tolist(),
                    }
                    for index, joint in enumerate(JOINTS)
                },
                "bars": {
                    bar: dict(
                        zip(COMPONENTS, loads.extremes()[leg].tolist(), strict=True),
                        utilization=float(use[leg, number]),
                    )
                    for number, (bar, loads) in enumerate(all_bar_loads(forces).items())
                },
            }
            for leg in range(3)
        ],
    }  # fmt: skip


def _motion_data(found: MotionLoads) -> dict[str, Any]:
    use = found.utilization.max(axis=0)
    return {
        "made_by": f"paminsa_viz {__version__}",
        "design": found.design.name,
        "trajectory": found.trajectory.name,
        "legs": [
            {
                "joints": {
                    joint.key: {
                        "peak_N": float(found.peak[leg, index]),
                        "peak_t_s": float(found.peak_time[leg, index]),
                        "rms_N": float(found.rms[leg, index]),
                        "equivalent_N": float(found.equivalent[leg, index]),
                        "travel": float(found.travel[leg, index]),
                    }
                    for index, joint in enumerate(JOINTS)
                },
                "bars": {
                    bar: dict(
                        zip(COMPONENTS, found.bar_peak[leg, number].tolist(), strict=True),
                        utilization=float(use[leg, number]),
                    )
                    for number, bar in enumerate(BARS)
                },
            }
            for leg in range(3)
        ],
    }
