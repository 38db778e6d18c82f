"""The robot as files of other programs: what there is, and what each is for.

The command ``paminsa-viz export`` reads `TARGETS`; the page's *File > Export* reads `CODE` as well,
which is what ``paminsa-viz code`` writes into a folder.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING

from paminsa_viz.files.archives import zipped
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.design import Design
from paminsa_viz.model.kinematics import inverse_kinematics

if TYPE_CHECKING:
    from paminsa_viz.codegen.fmu import FmuKind

Files = dict[str, bytes]
"""Contents by what follows the file's name: its ending, or that of a file beside it."""


@dataclass(frozen=True)
class Target:
    """A kind of file.

    Attributes:
        label: What people call it.
        endings: Endings of the file; the first is what the page takes.
        use: What it is for, in a few words.
        make: Makes the contents of a design at a pose (4,) [m, m, rad, m]; position servos about
            the pose, or plain motors, where the format has actuators.
        posed: Whether the pose is in the contents.
    """

    label: str
    endings: tuple[str, ...]
    use: str
    make: Callable[[Design, Array, bool], Files]
    posed: bool = True

    def files(self, design: Design, pose: Array, *, servos: bool = True) -> Files:
        """Return the contents of the file and of those beside it, by their endings.

        Raises:
            InvalidDesign: If a bar's inertias belong to no rigid body.
            InvalidInput: If the format cannot hold the design, or nothing could hold the pose.
            UnreachablePose: If the robot cannot be in the pose.
        """
        return self.make(design, pose, servos)


# Each imports late: meshes and engines bring large libraries.


def _glb(design: Design, pose: Array, servos: bool) -> Files:
    from paminsa_viz.meshes import assemble_glb

    del servos
    return {".glb": assemble_glb(design, inverse_kinematics(design.geometry, pose))}


def _mjcf(design: Design, pose: Array, servos: bool) -> Files:
    from paminsa_viz.engines.exported import exported_mjcf

    return {".xml": exported_mjcf(design, pose=pose.tolist(), servos=servos).encode()}


def _usd(design: Design, pose: Array, servos: bool) -> Files:
    from paminsa_viz.engines.exported import exported_usd

    return {".usda": exported_usd(design, pose=pose.tolist(), servos=servos).encode()}


def _urdf(design: Design, pose: Array, servos: bool) -> Files:
    from paminsa_viz.engines.urdf import closure_table, urdf_text

    del pose, servos
    closures = json.dumps(closure_table(design), indent=2) + "\n"
    return {".urdf": urdf_text(design).encode(), ".loops.json": closures.encode()}


def _dxf(design: Design, pose: Array, servos: bool) -> Files:
    from paminsa_viz.engines.dxf import dxf_text

    del servos
    return {".dxf": dxf_text(design, pose=pose.tolist()).encode()}


def _c(design: Design, pose: Array, servos: bool) -> Files:
    from paminsa_viz.codegen.kit import controller_kit

    del pose, servos
    kit = {name: text.encode() for name, text in controller_kit(design).items()}
    return {".zip": zipped(kit, "controller")}


def _fmu(design: Design, pose: Array, servos: bool, *, kind: FmuKind) -> Files:
    from paminsa_viz.codegen.fmu import build_fmu

    del pose, servos
    return {".fmu": build_fmu(design, kind)}


TARGETS: Mapping[str, Target] = {
    "glb": Target("GLB", (".glb",), "a 3D model: Blender, CAD viewers, slides", _glb),
    "mjcf": Target(
        "MJCF", (".xml", ".mjcf"), "MuJoCo, Pinocchio: all masses, loops, actuators", _mjcf
    ),
    "usd": Target("USD", (".usda",), "Isaac Sim, Newton: bodies, loops, drives", _usd),
    "urdf": Target(
        "URDF",
        (".urdf",),
        "ROS: a tree, with a table of its loops beside it",
        _urdf,
        posed=False,
    ),
    "dxf": Target("DXF", (".dxf",), "CAD: center lines from above and in the legs’ planes", _dxf),
}
"""Kinds of files by the flag of the command."""

CODE: Mapping[str, Target] = {
    "controller": Target(
        "C", (".zip",), "controllers: kinematics and dynamics in one header", _c, posed=False
    ),
    "plant": Target(
        "FMU plant", (".fmu",), "Simulink, Modelica: torques in, motion out",
        partial(_fmu, kind="plant"), posed=False,
    ),
    "inverse": Target(
        "FMU inverse", (".fmu",), "the same: a motion in, torques out",
        partial(_fmu, kind="inverse"), posed=False,
    ),
}  # fmt: skip
"""What is made of the design's formulas, by name."""
