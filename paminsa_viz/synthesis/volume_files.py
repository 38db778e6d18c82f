"""A volume as files: its surface as STL and GLB, its nodes as a table."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from paminsa_viz import palette
from paminsa_viz.errors import InvalidInput
from paminsa_viz.files.tables import TABLE_FORMATS, DataTable, provenance, table_bytes
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.design import stated_parameters
from paminsa_viz.quantities.requirement_text import requirement_text
from paminsa_viz.synthesis.surface import VolumeSurface, cause_color, volume_surface
from paminsa_viz.synthesis.volume import Volume
from paminsa_viz.units import MM, si_unit

FORMAT = "paminsa_viz volume 1"
"""Name and version of the table's layout."""


def volume_stl(surface: VolumeSurface) -> bytes:
    """Return a surface as binary STL, in millimeters as CAD programs take it, z up."""
    corners = (surface.vertices * MM)[surface.faces].astype("<f4")
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    length = np.linalg.norm(normal, axis=1, keepdims=True)
    record = np.zeros(
        len(corners), dtype=[("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("extra", "<u2")]
    )
    record["normal"] = normal / np.where(length > 0.0, length, 1.0)
    record["corners"] = corners
    head = b"paminsa_viz volume, millimeters".ljust(80)
    return head + np.array(len(corners), "<u4").tobytes() + record.tobytes()


def volume_glb(surface: VolumeSurface) -> bytes:
    """Return a surface as GLB, in meters with y up as glTF wants; a colored node for each cause.

    Below the node ``volume``, in which z is up, a node is named by its cause, such as
    ``stretched:leg2``.
    """
    # Late: the library takes half a second to load.
    import trimesh
    from trimesh.visual import TextureVisuals
    from trimesh.visual.material import PBRMaterial

    from paminsa_viz.meshes.part import glb_bytes

    scene = trimesh.Scene()
    turn = np.array([[1, 0, 0, 0], [0, 0, 1, 0], [0, -1, 0, 0], [0, 0, 0, 1]], float)
    scene.graph.update(frame_to="volume", frame_from=scene.graph.base_frame, matrix=turn)
    for cause, (vertices, faces) in surface.parts().items():
        mesh = trimesh.Trimesh(vertices, faces, process=False)
        color = [channel / 255 for channel in palette.rgb(cause_color(cause))]
        mesh.visual = TextureVisuals(
            material=PBRMaterial(
                name=cause.text, baseColorFactor=[*color, 1.0], metallicFactor=0.0,
                roughnessFactor=0.8, doubleSided=True,
            )
        )  # fmt: skip
        scene.add_geometry(
            mesh, node_name=cause.word, geom_name=cause.word, parent_node_name="volume"
        )
    return glb_bytes(scene)


def volume_table(volume: Volume) -> DataTable:
    """Return the nodes that can be reached, and those next to them, along z first.

    The columns are x, y and z, the cause in words, the estimated distance to the surface (negative
    outside), and the least margin of each requirement over its headings, NaN out of reach. A binary
    file holds the axes and arrays (x, y, z) of all nodes instead, and ``cause_words`` by code.
    """
    # Late: it takes a third of a second to load.
    from scipy import ndimage

    near: NDArray[np.bool_] = np.asarray(ndimage.binary_dilation(volume.reachable), np.bool_)
    places = zip((volume.x, volume.y, volume.z), np.nonzero(near), strict=True)
    x, y, z = (np.round(axis[i], 9) for axis, i in places)
    words = np.array([cause.word for cause in volume.causes])
    margins: dict[str, Array] = {}
    for index, bound in enumerate(volume.requirements.bounds):
        unit = si_unit(bound.entry.unit).replace(" ", "").replace("/", "_per_").replace("^", "")
        suffix = f"_{unit}" if unit not in ("", "1") else ""
        margins[f"margin{index + 1}_{bound.quantity}{suffix}"] = volume.margins[index]
    columns: dict[str, NDArray[Any]] = {
        "x_m": x, "y_m": y, "z_m": z, "cause": words[volume.cause[near]],
        "depth_m": np.round(volume.depth[near], 7),
        **{name: values[near] for name, values in margins.items()},
    }  # fmt: skip
    arrays: dict[str, NDArray[Any]] = {
        "x_m": volume.x, "y_m": volume.y, "z_m": volume.z, "cause": volume.cause,
        "cause_words": words, "depth_m": volume.depth,
    }  # fmt: skip
    return DataTable(columns, provenance(FORMAT, _facts(volume)), arrays | margins)


def _facts(volume: Volume) -> dict[str, str]:
    theta = volume.requirements.theta
    facts = {
        "design": volume.design.name,
        "assembly": volume.design.geometry.knee.value,
        "headings [deg]": f"{math.degrees(theta[0]):.10g} to {math.degrees(theta[1]):.10g}",
        "headings sampled": str(volume.headings),
    }
    for index, bound in enumerate(volume.requirements.bounds):
        facts[f"requirement {index + 1}"] = requirement_text(bound)
    facts |= {
        "volume [m^3]": repr(volume.volume),
        "error of the volume [m^3]": repr(volume.error),
        "reachable volume [m^3]": repr(volume.reachable_volume),
        "cell [m]": repr(volume.cell),
    }
    for item in stated_parameters(volume.design):
        name = f"design {item.path}" + (f" [{item.unit}]" if item.unit else "")
        facts[name] = repr(float(volume.design.value(item.path)))
    return facts


def _surface(write: Callable[[VolumeSurface], bytes]) -> Callable[[Volume], bytes]:
    return lambda volume: write(volume_surface(volume))


def _table(kind: str) -> Callable[[Volume], bytes]:
    return lambda volume: table_bytes(volume_table(volume), kind)


VOLUME_FORMATS: dict[str, Callable[[Volume], bytes]] = {
    "stl": _surface(volume_stl),
    "glb": _surface(volume_glb),
    **{kind: _table(kind) for kind in TABLE_FORMATS},
}
"""What writes a volume, by the ending of the file."""


def volume_bytes(volume: Volume, kind: str) -> bytes:
    """Return a volume as a file of one of `VOLUME_FORMATS`.

    Raises:
        InvalidInput: If there is no such format, or the volume is empty and the format a surface.
    """
    if kind not in VOLUME_FORMATS:
        raise InvalidInput("kind", f"{', '.join(VOLUME_FORMATS)} are possible, not {kind!r}")
    if volume.empty and kind not in TABLE_FORMATS:
        raise InvalidInput("volume", "it is empty, and has no surface to write")
    return VOLUME_FORMATS[kind](volume)
