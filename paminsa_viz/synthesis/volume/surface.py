"""The surface of a volume, which cause cuts it where, and a volume as files."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from paminsa_viz import palette
from paminsa_viz.checks import kinds_checked
from paminsa_viz.errors import InvalidInput
from paminsa_viz.files.tables import TABLE_FORMATS, DataTable, provenance, table_bytes
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.design import stated_parameters
from paminsa_viz.quantities.requirement_text import requirement_text
from paminsa_viz.synthesis.volume.causes import INSIDE, CauseKind, VolumeCause, zero_surface
from paminsa_viz.synthesis.volume.solve import Volume
from paminsa_viz.units import MM, si_unit

FACES = 20_000
"""Faces of a surface, at most, unless another number is asked for."""

_AGGRESSIVENESS = 4
"""How soon simplification gives up shape; with 5 and more, small shells come off thin places."""

_BEYOND = (CauseKind.SINGULAR, CauseKind.REACH)
"""Causes at nodes where requirements are not evaluated."""

_KIND_COLORS = {
    CauseKind.INSIDE: palette.OK,
    CauseKind.OTHER_SIDE: palette.PLATFORM,
    CauseKind.SINGULAR: palette.BAD,
    CauseKind.DISCONNECTED: palette.INK,
    CauseKind.REACH: palette.MUTED,
}
_REQUIREMENT_COLORS = (
    "#E69F00", "#56B4E9", "#CC79A7", "#009E73", "#F0E442", "#7A5195", "#0072B2", "#D55E00",
)  # fmt: skip


def cause_color(cause: VolumeCause) -> str:
    """Return the color ``#rrggbb`` of a cause: one a requirement, one for all limits of reach."""
    if cause.requirement is None:
        return _KIND_COLORS[cause.kind]
    return _REQUIREMENT_COLORS[cause.requirement % len(_REQUIREMENT_COLORS)]


@dataclass(frozen=True, eq=False)
class VolumeSurface:
    """The closed surface of a volume; its faces' normals point outward.

    Attributes:
        vertices: (n, 3) [m].
        faces: (m, 3) indices of vertices.
        cause: (n,) code of what cuts at a vertex, see `Volume.causes`.
        causes: What the codes mean.
    """

    vertices: Array
    faces: NDArray[np.int64]
    cause: NDArray[np.uint8]
    causes: tuple[VolumeCause, ...]

    @property
    def face_cause(self) -> NDArray[np.uint8]:
        """Code of what cuts at a face (m,): that of two of its vertices, or of the first."""
        a, b, c = self.cause[self.faces].T
        return np.where(b == c, b, a)

    def parts(self) -> dict[VolumeCause, tuple[Array, NDArray[np.int64]]]:
        """Return vertices (n, 3) [m] and faces (m, 3) of the part that each cause cuts."""
        found, code = {}, self.face_cause
        for each in np.unique(code):
            used, faces = np.unique(self.faces[code == each], return_inverse=True)
            found[self.causes[each]] = (self.vertices[used], faces.reshape(-1, 3))
        return found

    def areas(self) -> dict[VolumeCause, float]:
        """Return the area that each cause cuts [m^2], the largest first."""
        found = {}
        for cause, (vertices, faces) in self.parts().items():
            a, b, c = (vertices[faces[:, i]] for i in range(3))
            found[cause] = float(np.linalg.norm(np.cross(b - a, c - a), axis=1).sum()) / 2.0
        return dict(sorted(found.items(), key=lambda item: -item[1]))


@kinds_checked
def volume_surface(volume: Volume, *, faces: int = FACES) -> VolumeSurface:
    """Return the surface of a volume, by marching cubes, with fewer faces where it is flat.

    Args:
        volume: The volume; if it is empty, so is the surface.
        faces: Largest number of faces.
    """
    if volume.empty:
        none = np.empty((0, 3))
        return VolumeSurface(none, none.astype(np.int64), np.empty(0, np.uint8), volume.causes)
    nodes, triangles = zero_surface(volume.depth)
    cause = _cause_at(volume, nodes)
    vertices = nodes * volume.cell + [volume.x[0], volume.y[0], volume.z[0]]
    if len(triangles) > faces:
        # Late: needed only for surfaces, and it takes its time to load.
        import fast_simplification

        fewer, folded = fast_simplification.simplify(
            vertices, triangles.astype(np.int32), target_count=max(faces, 4), agg=_AGGRESSIVENESS
        )[:2]
        used, corners = np.unique(_without_folds(folded), return_inverse=True)
        kept = np.asarray(fewer, float)[used]
        cause = cause[_nearest(vertices, kept)]
        vertices, triangles = kept, corners.reshape(-1, 3).astype(np.int64)
    return VolumeSurface(vertices, triangles, cause, volume.causes)


def _without_folds(triangles: NDArray[np.integer[Any]]) -> NDArray[np.integer[Any]]:
    """Return faces without those that lie back to back on the same vertices.

    Merging edges can fold two faces onto each other. They enclose nothing, and four faces then meet
    at the edge from which they stand out, which programs for CAD and print refuse.
    """
    corners = np.sort(triangles, axis=1)
    _, which, count = np.unique(corners, axis=0, return_inverse=True, return_counts=True)
    return triangles[count[which.ravel()] == 1]


def _cause_at(volume: Volume, nodes: Array) -> NDArray[np.uint8]:
    """Return what cuts the volume at points on edges of the grid.

    It is the cause at the edge's node outside. Where that cannot be reached, requirements are not
    known there, and one may end the volume before reach or the singularity does: then it is what
    is nearest to the node inside.
    """
    top = np.array(volume.cause.shape) - 1
    first, second = (
        tuple(np.clip(round_(nodes).astype(int), 0, top).T) for round_ in (np.floor, np.ceil)
    )
    swapped = volume.cause[first] != INSIDE
    inner = tuple(np.where(swapped, b, a) for a, b in zip(first, second, strict=True))
    outer = tuple(np.where(swapped, a, b) for a, b in zip(first, second, strict=True))
    cause = volume.cause[outer]
    kinds = np.array([each.kind in _BEYOND for each in volume.causes])
    hidden = kinds[cause] & (volume.depth[inner] < volume.cell)
    return np.where(hidden | (cause == INSIDE), volume.nearest[inner], cause)


def _nearest(points: Array, queries: Array) -> NDArray[np.intp]:
    """Return the index of the nearest of some points to each other point."""
    # Late: needed only for surfaces, and it takes its time to load.
    from scipy.spatial import KDTree

    return np.asarray(KDTree(points).query(queries)[1], np.intp)


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


@kinds_checked
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
    each = zip(volume.requirements.bounds, volume.margins, strict=True)
    for index, (bound, margin) in enumerate(each):
        unit = si_unit(bound.entry.unit).replace(" ", "").replace("/", "_per_").replace("^", "")
        suffix = f"_{unit}" if unit not in ("", "1") else ""
        margins[f"margin{index + 1}_{bound.quantity}{suffix}"] = margin
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
        "knee": volume.design.geometry.knee.value,
        "headings [deg]": f"{math.degrees(theta[0]):.10g} to {math.degrees(theta[1]):.10g}",
        "headings sampled": str(volume.sampled_headings),
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


VOLUME_FORMATS = ("stl", "glb", *TABLE_FORMATS)
"""Endings of the files that a volume can be written to."""


@kinds_checked
def volume_bytes(volume: Volume, kind: str) -> bytes:
    """Return a volume as a file of one of `VOLUME_FORMATS`.

    Raises:
        InvalidInput: If there is no such format, or the volume is empty and the format a surface.
    """
    if kind not in VOLUME_FORMATS:
        raise InvalidInput("kind", f"{', '.join(VOLUME_FORMATS)} are possible, not {kind!r}")
    if kind in TABLE_FORMATS:
        return table_bytes(volume_table(volume), kind)
    if volume.empty:
        raise InvalidInput("volume", "it is empty, and has no surface to write")
    surface = volume_surface(volume)
    return volume_stl(surface) if kind == "stl" else volume_glb(surface)
