"""``paminsa-viz export``: the posed robot for other programs."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import numpy as np
import tyro

from paminsa_viz.cli.arguments import OrNone, UsageError, check_needs
from paminsa_viz.cli.flags import DesignFlags, PoseFlags, check_output
from paminsa_viz.cli.output import print_left_out, print_written
from paminsa_viz.engines.exported import exported_mjcf
from paminsa_viz.exports import TARGETS
from paminsa_viz.files.archives import zipped
from paminsa_viz.files.atomic import check_folder, check_writable, write_files
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.design import Design
from paminsa_viz.model.kinematics import inverse_kinematics
from paminsa_viz.model.reach import require_reachable

DESCRIPTION = """\
Write the robot at a pose for other programs.

  paminsa-viz export --glb robot.glb            a 3D model: Blender, CAD viewers, slides
  paminsa-viz export --mjcf robot.xml           one file for MuJoCo: all masses, loops, actuators
  paminsa-viz export --meshes robot             a folder for MuJoCo with the real shapes too
  paminsa-viz export --usd robot.usda           Isaac Sim and Newton: bodies, loops, drives
  paminsa-viz export --urdf robot.urdf          ROS: a tree, and robot.loops.json with its loops
  paminsa-viz export --dxf robot.dxf            CAD: center lines from above and in the legs' planes
  paminsa-viz export --meshes robot.zip --design robot.toml --pose 50 -30 20 -550

Try `python -m mujoco.viewer --mjcf=robot/robot.xml`: the sliders move the four actuators. Pinocchio
4 reads the same file with its loops (buildModelAndLegacyConstraintsFromMJCF)."""


@dataclass(frozen=True, kw_only=True)
class Export(PoseFlags, DesignFlags):
    """Flags of the command."""

    glb: Annotated[OrNone[Path], tyro.conf.arg(metavar="FILE.glb")] = None
    """Write the posed robot as GLB."""
    mjcf: Annotated[OrNone[Path], tyro.conf.arg(metavar="FILE.xml")] = None
    """Write the MuJoCo model with simple shapes, in one file."""
    meshes: Annotated[OrNone[Path], tyro.conf.arg(metavar="FOLDER|FILE.zip")] = None
    """Write the MuJoCo model with the robot's shapes: robot.xml and meshes/*.obj."""
    usd: Annotated[OrNone[Path], tyro.conf.arg(metavar="FILE.usda")] = None
    """Write the USD stage with UsdPhysics: bodies, joints, the twelve loops, drives."""
    urdf: Annotated[OrNone[Path], tyro.conf.arg(metavar="FILE.urdf")] = None
    """Write the URDF, a tree with mimicking joints, and its loops beside it: FILE.loops.json."""
    dxf: Annotated[OrNone[Path], tyro.conf.arg(metavar="FILE.dxf")] = None
    """Write the posed skeleton as a drawing: from above, and each leg in its plane."""
    motors: bool = False
    """Give the MuJoCo and USD models plain motors instead of position servos about the pose."""

    def run(self) -> int:
        """Write the files."""
        given = {name: path for name in TARGETS if (path := getattr(self, name)) is not None}
        if not given and self.meshes is None:
            *flags, last = (f"--{name}" for name in (*TARGETS, "meshes"))
            raise UsageError(f"nothing to write; give {', '.join(flags)} or {last}")
        driven = self.mjcf or self.meshes or self.usd
        check_needs(self, driven, "--mjcf, --meshes or --usd", "motors")
        for name, path in given.items():
            check_output(f"--{name}", path, TARGETS[name].endings)
        if self.meshes is not None and self.meshes.suffix.lower() in _OTHER_THAN_FOLDERS:
            raise UsageError(f"--meshes {self.meshes}: a folder or a .zip file is needed")
        if self.meshes is not None and self.meshes.suffix.lower() != ".zip":
            check_folder(self.meshes)
        design = self.given_design()
        pose = np.array(self.given_pose(design.geometry))
        require_reachable(design.geometry, pose)
        # All of it is made before the first file is written, so that a refused pose leaves none.
        files = {
            path.with_suffix(ending) if beside else path: content
            for name, path in given.items()
            for beside, (ending, content) in enumerate(
                TARGETS[name].files(design, pose, servos=not self.motors).items()
            )
        }
        for path in files:  # of these no folder is made
            check_writable(path)
        parts: dict[Path, str | bytes] = {}
        if self.meshes is not None and self.meshes.suffix.lower() == ".zip":
            files[self.meshes] = zipped(self._meshes(design, pose), self.meshes.stem)
            check_writable(self.meshes)
        elif self.meshes is not None:
            meshes = self._meshes(design, pose)
            parts = {self.meshes / name: content for name, content in meshes.items()}
        write_files({**files, **parts})
        print_written(list(files))
        if parts:
            print(f"{self.meshes}: written, {len(parts)} files")
        print_left_out(design)
        return 0

    def _meshes(self, design: Design, pose: Array) -> dict[str, bytes]:
        """Return the files of the MuJoCo model with the robot's shapes."""
        # Late: the shapes' libraries take a second to load.
        from paminsa_viz.meshes.robot_files import robot_files

        text = exported_mjcf(design, pose=pose.tolist(), servos=not self.motors)
        return robot_files(text, design, inverse_kinematics(design.geometry, pose))


_OTHER_THAN_FOLDERS = (*(e for target in TARGETS.values() for e in target.endings), ".obj", ".stl")

FLAGS = Export
