"""Write the mesh files of the fixed parts: ``python assets/make_parts.py [folder]``."""

from __future__ import annotations

import inspect
import sys
from pathlib import Path

import trimesh
from parts import PARTS

from paminsa_viz.meshes.bodies import SMALL
from paminsa_viz.meshes.part import PLAIN, Z_UP, MeshPart, checkout_folder, glb_bytes
from paminsa_viz.meshes.solids import plain_shapes

TABLE_HEAD = """# Parts of fixed shape

Written by `python assets/make_parts.py`; do not edit by hand. Bars, arms, shafts, guide links,
the platform's plate and the frame follow the lengths of the design and are made when needed
(`paminsa_viz/meshes/bodies.py`, `frame.py`). The folder `plain` has the same parts with few faces
and without small details, for browsers that draw without a graphics card.

Lengths are in meters. Each part's own frame has z up; as glTF wants y up, the node `z_up` of each
file turns it. Each mesh is named after its material; `accent` takes the color of a leg or of M4.

| file | what it is and where its frame lies | size x, y, z [mm] | triangles |
|---|---|---|---|
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
    for make in PARTS:
        part = make()
        with plain_shapes():
            plain = make().without_small(SMALL)
        name = f"{make.__name__}.glb"
        for path, made in ((folder / name, part), (folder / PLAIN / name, plain)):
            if made.solids:
                path.write_bytes(part_glb(made))
                paths.append(path)
        low, high = part.bounds() * 1e3
        size = " x ".join(f"{length:.0f}" for length in high - low)
        faces = sum(len(solid.mesh.faces) for solid in part.solids)
        what = " ".join((inspect.getdoc(make) or "").split())
        rows.append(f"| `{name}` | {what} | {size} | {faces} |")
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
