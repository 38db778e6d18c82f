"""Write the mesh files of the fixed parts: ``python assets/make_parts.py [folder]``."""

from __future__ import annotations

import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Final

import actuator_parts
import joint_parts
import trimesh

from paminsa_viz.meshes.bodies import SMALL
from paminsa_viz.meshes.library import PLAIN, Z_UP, checkout_folder
from paminsa_viz.meshes.load import LOAD_DENSITY
from paminsa_viz.meshes.part import MeshPart, glb_bytes
from paminsa_viz.meshes.solids import plain_shapes


@dataclass(frozen=True)
class Fitting:
    """A fixed part with its file name (without suffix) and what a reader needs to know of it."""

    name: str
    make: Callable[[], MeshPart]
    purpose: str
    frame: str


CATALOG: Final[tuple[Fitting, ...]] = (
    Fitting(
        "rotary_actuator",
        actuator_parts.rotary_actuator,
        "housing of the rotating actuators M1 to M3, with a bore for the quill",
        "leg axis at the mounting face; +z away from the guides; connector toward +x",
    ),
    Fitting(
        "quill",
        actuator_parts.quill,
        "hollow shaft turned by M1 to M3, with the block that holds guide link B10",
        "leg axis at the height of the guides; guide link toward -x",
    ),
    Fitting(
        "slider",
        joint_parts.slider,
        "slider on the guide with the pin of joint 8 (B8 on one side, B7 on the other)",
        "joint 8; x along the guide, y across the leg plane",
    ),
    Fitting(
        "barrel", joint_parts.barrel, "bearing barrel at a joint of a bar", "middle; axis along y"
    ),
    Fitting(
        "bar_end",
        joint_parts.bar_end,
        "socket between a barrel and the tube of a bar",
        "middle of the barrel; tube toward +x",
    ),
    Fitting(
        "shaft_end",
        joint_parts.shaft_end,
        "head of shaft B2 with the pin of joint 3, which carries B3",
        "joint 3; +z up the shaft, y across the leg plane",
    ),
    Fitting(
        "arm_bearing", joint_parts.arm_bearing, "bearing of joint 2 at the tip of an arm", "joint 2"
    ),
    Fitting("shaft_nut", joint_parts.shaft_nut, "nut and collar of shaft B2 at joint 2", "joint 2"),
    Fitting(
        "lift_carriage",
        actuator_parts.lift_carriage,
        "carriage of the linear actuator M4, which carries the three arms B1",
        "robot axis at the height of the arms",
    ),
    Fitting(
        "lift_foot", actuator_parts.lift_foot, "flange under M4's column", "robot axis on the plate"
    ),
    Fitting(
        "lift_motor",
        actuator_parts.lift_motor,
        "head of M4: end plate and motor",
        "under the end plate",
    ),
    Fitting(
        "swivel_disc", joint_parts.swivel_disc, "foot of joint 5 on the platform", "joint 5; +z up"
    ),
    Fitting(
        "swivel_head",
        joint_parts.swivel_head,
        "head of joint 5, which turns on the platform, with the pin that carries B4",
        "joint 5; x along and y across the leg plane",
    ),
    Fitting(
        "tool_flange",
        joint_parts.tool_flange,
        "flange under the platform",
        "middle of the plate's lower face",
    ),
    Fitting(
        "payload",
        joint_parts.payload,
        f"load of 1 kg at {LOAD_DENSITY:.0f} kg/m^3, scaled to others",
        "middle of its upper face",
    ),
    Fitting(
        "mast_foot",
        actuator_parts.mast_foot,
        "foot of the mast",
        "on the ground; x away from the robot",
    ),
)
"""Every part that is kept as a mesh file."""


TABLE_HEAD = """# Parts of fixed shape

Written by `python assets/make_parts.py`; do not edit by hand. Bars, arms, shafts, guide links,
the platform's plate and the frame follow the lengths of the design and are made when needed
(`paminsa_viz/meshes/bodies.py`, `frame.py`). The folder `plain` has the same parts with few faces
and without small details, for browsers that draw without a graphics card.

Lengths are in meters. Each part's own frame has z up; as glTF wants y up, the node `z_up` of each
file turns it. Each mesh is named after its material; `accent` takes the color of a leg or of M4.

| file | what it is | origin and axes | size x, y, z [mm] | triangles |
|---|---|---|---|---|
"""


def part_glb(part: MeshPart) -> bytes:
    """Return a part as a GLB file with y up, one named mesh for each material."""
    scene = trimesh.Scene()
    scene.graph.update(frame_to="z_up", frame_from=scene.graph.base_frame, matrix=Z_UP)
    for name, mesh in part.colored().items():
        scene.add_geometry(mesh, node_name=name, geom_name=name, parent_node_name="z_up")
    return glb_bytes(scene)


def write_parts(folder: Path) -> list[Path]:
    """Write every fixed part and the table that lists them; return the paths written.

    The same program writes the same bytes every time.
    """
    (folder / PLAIN).mkdir(parents=True, exist_ok=True)
    paths, rows = [], []
    for fitting in CATALOG:
        part = fitting.make()
        with plain_shapes():
            plain = fitting.make().without_small(SMALL)
        name = f"{fitting.name}.glb"
        for path, made in ((folder / name, part), (folder / PLAIN / name, plain)):
            if made.solids:
                path.write_bytes(part_glb(made))
                paths.append(path)
        low, high = part.bounds() * 1e3
        size = " x ".join(f"{length:.0f}" for length in high - low)
        faces = sum(len(solid.mesh.faces) for solid in part.solids)
        rows.append(f"| `{name}` | {fitting.purpose} | {fitting.frame} | {size} | {faces} |")
    table = folder / "README.md"
    table.write_text(TABLE_HEAD + "\n".join(rows) + "\n", encoding="utf-8")
    return [*paths, table]


def main(arguments: list[str]) -> int:
    """Write the files to the folder given, or to ``assets/meshes``; return the exit status."""
    if len(arguments) > 1 or any(item.startswith("-") for item in arguments):
        print("usage: python assets/make_parts.py [folder]", file=sys.stderr)
        return 2
    folder = Path(arguments[0]) if arguments else checkout_folder()
    for path in write_parts(folder):
        print(path)
    return 0


if __name__ == "__main__":
    raise SystemExit(main(sys.argv[1:]))
