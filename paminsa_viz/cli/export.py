"""``paminsa-viz export``: the posed robot for other programs."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import numpy as np
import tyro

from paminsa_viz.cli.arguments import UsageError, parse
from paminsa_viz.cli.inputs import Assembly, design_of
from paminsa_viz.engines.exported import exported_mjcf
from paminsa_viz.engines.poses import start_pose
from paminsa_viz.files.atomic import as_file_error, write_bytes
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.design import Design
from paminsa_viz.model.kinematics import inverse_kinematics
from paminsa_viz.model.reach import require_reachable

DESCRIPTION = """\
Write the robot, standing in a pose, for other programs.

  paminsa-viz export --glb robot.glb            a 3D model: Blender, CAD viewers, slides
  paminsa-viz export --mjcf robot.xml           one file for MuJoCo: all masses, loops, actuators
  paminsa-viz export --meshes robot             a folder for MuJoCo with the real shapes too
  paminsa-viz export --meshes robot.zip --design robot.toml --pose 50 -30 20 -550

Try `python -m mujoco.viewer --mjcf=robot/robot.xml`: the sliders move the four actuators. Pinocchio
4 reads the same file with its loops (buildModelAndLegacyConstraintsFromMJCF)."""


@dataclass(frozen=True)
class Export:
    """Flags of the command."""

    glb: Annotated[Path | None, tyro.conf.arg(metavar="FILE.glb")] = None
    """Write the posed robot as GLB."""
    mjcf: Annotated[Path | None, tyro.conf.arg(metavar="FILE.xml")] = None
    """Write the MuJoCo model with simple shapes, in one file."""
    meshes: Annotated[Path | None, tyro.conf.arg(metavar="FOLDER|FILE.zip")] = None
    """Write the MuJoCo model with the robot's shapes: robot.xml and meshes/*.obj."""
    design: Annotated[Path | None, tyro.conf.arg(metavar="FILE")] = None
    """Design file (TOML), instead of the paper's Appendix 4."""
    assembly: Assembly | None = None
    """Branch of the knee 9: as Appendix 1 prints it (lower), or its mirror image; by default the
    design's own."""
    pose: Annotated[
        tuple[float, float, float, float] | None, tyro.conf.arg(metavar="X Y THETA Z")
    ] = None
    """Pose in mm, mm, degrees, mm; in the middle of the workspace if left out."""
    motors: bool = False
    """Give the MuJoCo models plain motors, whose controls are torques, instead of position servos
    about the pose."""


def main(words: list[str]) -> int:
    """Run the command."""
    flags = parse(Export, words, "export", DESCRIPTION)
    if flags.glb is None and flags.mjcf is None and flags.meshes is None:
        raise UsageError("nothing to write; give --glb, --mjcf or --meshes")
    design = design_of(flags.design, flags.assembly)
    if flags.pose is None:
        pose = start_pose(design)
    else:
        x, y, theta, z = flags.pose
        pose = np.array([1e-3 * x, 1e-3 * y, math.radians(theta), 1e-3 * z])
    require_reachable(design.geometry, pose)
    contents = _contents(flags, design, pose)
    for path, content in contents:
        if not isinstance(content, bytes):
            _make_folders(path, content)  # before any file: what most often cannot be made
    for path, content in contents:
        if isinstance(content, bytes):
            write_bytes(path, content)
            print(f"{path}: written")
        else:
            for name, part in content.items():
                write_bytes(path / name, part)
            print(f"{path}: written, {len(content)} files")
    return 0


def _contents(
    flags: Export, design: Design, pose: Array
) -> list[tuple[Path, bytes | dict[str, bytes]]]:
    """Return what was asked for: paths with their content, or with files by name for a folder.

    All of it is made before the first file is written, so that a refused pose leaves none behind.
    """
    # Late: the shapes' libraries take a second to load.
    from paminsa_viz.meshes import assemble_glb
    from paminsa_viz.meshes.robot_files import robot_files, zipped

    configuration = inverse_kinematics(design.geometry, pose)
    made: list[tuple[Path, bytes | dict[str, bytes]]] = []
    if flags.glb is not None:
        made.append((flags.glb, assemble_glb(design, configuration)))
    if flags.mjcf is not None or flags.meshes is not None:
        text = exported_mjcf(design, pose=pose.tolist(), servos=not flags.motors)
        if flags.mjcf is not None:
            made.append((flags.mjcf, text.encode()))
        if flags.meshes is not None:
            files = robot_files(text, design, configuration)
            packed = flags.meshes.suffix.lower() == ".zip"
            made.append((flags.meshes, zipped(files, flags.meshes.stem) if packed else files))
    return made


def _make_folders(folder: Path, files: Iterable[str]) -> None:
    try:
        for name in files:
            (folder / name).parent.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise as_file_error(str(folder), error, "written") from error
