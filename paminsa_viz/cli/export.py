"""``paminsa-viz export``: the posed robot for other programs."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import numpy as np
import tyro

from paminsa_viz.cli.arguments import UsageError
from paminsa_viz.cli.flags import DesignFlags, PoseFlags, check_output
from paminsa_viz.cli.output import print_written
from paminsa_viz.engines.exported import exported_mjcf
from paminsa_viz.engines.poses import start_pose
from paminsa_viz.files.atomic import make_folder, write_bytes
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.design import Design
from paminsa_viz.model.kinematics import inverse_kinematics
from paminsa_viz.model.reach import require_reachable

DESCRIPTION = """\
Write the robot at a pose for other programs.

  paminsa-viz export --glb robot.glb            a 3D model: Blender, CAD viewers, slides
  paminsa-viz export --mjcf robot.xml           one file for MuJoCo: all masses, loops, actuators
  paminsa-viz export --meshes robot             a folder for MuJoCo with the real shapes too
  paminsa-viz export --meshes robot.zip --design robot.toml --pose 50 -30 20 -550

Try `python -m mujoco.viewer --mjcf=robot/robot.xml`: the sliders move the four actuators. Pinocchio
4 reads the same file with its loops (buildModelAndLegacyConstraintsFromMJCF)."""


@dataclass(frozen=True, kw_only=True)
class Export(PoseFlags, DesignFlags):
    """Flags of the command."""

    glb: Annotated[Path | None, tyro.conf.arg(metavar="FILE.glb")] = None
    """Write the posed robot as GLB."""
    mjcf: Annotated[Path | None, tyro.conf.arg(metavar="FILE.xml")] = None
    """Write the MuJoCo model with simple shapes, in one file."""
    meshes: Annotated[Path | None, tyro.conf.arg(metavar="FOLDER|FILE.zip")] = None
    """Write the MuJoCo model with the robot's shapes: robot.xml and meshes/*.obj."""
    motors: bool = False
    """Give the MuJoCo models plain motors, whose controls are torques, instead of position servos
    about the pose."""

    def run(self) -> int:
        """Write the files."""
        if self.glb is None and self.mjcf is None and self.meshes is None:
            raise UsageError("nothing to write; give --glb, --mjcf or --meshes")
        check_output("--glb", self.glb, [".glb"])
        check_output("--mjcf", self.mjcf, [".xml", ".mjcf"])
        if self.meshes is not None and self.meshes.suffix.lower() in _OTHER_THAN_FOLDERS:
            raise UsageError(f"--meshes {self.meshes}: a folder or a .zip file is needed")
        design = self.given_design()
        pose = start_pose(design) if self.given_pose is None else np.array(self.given_pose)
        require_reachable(design.geometry, pose)
        files, folders = self._contents(design, pose)
        for folder, names in folders.items():  # first, as what most often cannot be made
            for parent in sorted({(folder / name).parent for name in names}):
                make_folder(parent)
        for path, content in files.items():
            write_bytes(path, content)
            print_written([path])
        for folder, parts in folders.items():
            for name, part in parts.items():
                write_bytes(folder / name, part)
            print(f"{folder}: written, {len(parts)} files")
        return 0

    def _contents(
        self, design: Design, pose: Array
    ) -> tuple[dict[Path, bytes], dict[Path, dict[str, bytes]]]:
        """Return files, and folders with their files.

        All of it is made before the first file is written, so that a refused pose leaves none.
        """
        # Late: the shapes' libraries take a second to load.
        from paminsa_viz.meshes import assemble_glb
        from paminsa_viz.meshes.robot_files import robot_files, zipped

        configuration = inverse_kinematics(design.geometry, pose)
        made: dict[Path, bytes] = {}
        if self.glb is not None:
            made[self.glb] = assemble_glb(design, configuration)
        if self.mjcf is None and self.meshes is None:
            return made, {}
        text = exported_mjcf(design, pose=pose.tolist(), servos=not self.motors)
        if self.mjcf is not None:
            made[self.mjcf] = text.encode()
        if self.meshes is None:
            return made, {}
        files = robot_files(text, design, configuration)
        if self.meshes.suffix.lower() != ".zip":
            return made, {self.meshes: files}
        return made | {self.meshes: zipped(files, self.meshes.stem)}, {}


_OTHER_THAN_FOLDERS = (".glb", ".xml", ".obj", ".stl")

FLAGS = Export
