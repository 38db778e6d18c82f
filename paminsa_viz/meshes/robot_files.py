"""The robot in one pose for other programs: as a GLB, and as MuJoCo's model with its real shapes.

`paminsa_viz.engines.mjcf` writes the mechanics, with capsules for looks. `robot_files` puts each
body's meshes on top, as geoms without mass that touch nothing, so that the mechanics do not change.
The capsules move to group 3, which viewers hide by default.

One shape has no body of its own: the swivels of joint 5, on which the mechanics put a point mass.
Their round feet go with the platform; their heads and pins go with B4, as they are at the start.
"""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Iterator, Mapping
from typing import Final, cast

import numpy as np
import trimesh
from scipy.spatial.transform import Rotation
from trimesh.exchange.obj import export_obj

from paminsa_viz import palette
from paminsa_viz.dimensions.placement import BODIES, place_parts
from paminsa_viz.engines.mechanism import LIFT, PLATFORM
from paminsa_viz.errors import InvalidInput
from paminsa_viz.meshes import bodies, loads
from paminsa_viz.meshes.part import (
    ACCENT,
    SURFACES,
    Z_UP,
    MeshPart,
    add_part,
    fixed_part,
    glb_bytes,
)
from paminsa_viz.meshes.solids import Array
from paminsa_viz.model.accuracy import equal_legs_note
from paminsa_viz.model.arguments import of_design
from paminsa_viz.model.design import Design
from paminsa_viz.model.grids import COORDINATES
from paminsa_viz.model.kinematics import Configuration

ROOT: Final = "base"
CAPSULES: Final = "3"
"""Group of the schematic geoms; MuJoCo's viewer shows groups 0 to 2."""

_CARRIERS: Final = {
    "guide": "B10", "shaft": "B2", "slider": "slider", "b3": "B3", "b4": "B4", "b7": "B7",
    "b8": "B8",
}  # fmt: skip
"""Bodies of a leg in `paminsa_viz.dimensions.placement`, and the MuJoCo bodies that carry them."""


@of_design
def assemble_glb(design: Design, configuration: Configuration, *, ground: bool = True) -> bytes:
    """Return the posed robot as a GLB with one named node for each body.

    Lengths are in meters and y is up, as glTF wants: the node "paminsa" turns the base frame, in
    which z is up. Below it each body is a node named as in `paminsa_viz.dimensions.placement`
    (``leg1_b3`` for ``leg1/b3``), whose children are its meshes by material, and its counterweights
    (``leg1_b3_weight1``). The file's scene carries the pose and the design's name as extras.

    Args:
        design: Lengths, payload and counterweights; its geometry is the configuration's.
        configuration: A solved configuration of shape () that can be taken.
        ground: Whether the plinth is included.

    Raises:
        InvalidInput: If the configuration is a batch, is not finite for some joint, or belongs to
            another geometry.
    """
    if configuration.geometry != design.geometry:
        raise InvalidInput("configuration", "it was solved for another geometry than the design's")
    if configuration.pose.shape != (4,):
        raise InvalidInput(
            "configuration", f"one pose is needed; its shape is {configuration.pose.shape}"
        )
    places = place_parts(configuration)
    if not all(
        np.isfinite(p.position).all() and np.isfinite(p.wxyz).all() for p in places.values()
    ):
        raise InvalidInput("configuration", "the bars cannot close in this pose")
    geometry = design.geometry
    scene = trimesh.Scene()
    scene.metadata.update(
        design=design.name,
        knee=geometry.knee.value,
        pose=dict(zip(COORDINATES, map(float, configuration.pose), strict=True)),
        units="m, rad",
        **({"legs": note} if (note := equal_legs_note(design.deviations)) else {}),
        up="y (the node paminsa turns the base frame, in which z is up)",
    )
    scene.graph.update(frame_to="paminsa", frame_from=scene.graph.base_frame, matrix=Z_UP)
    for body in (*bodies.STANDING, *BODIES):
        if body == "ground" and not ground:
            continue
        matrix = places[body].matrix if body in places else np.eye(4)
        part = bodies.make_body(geometry, body)
        add_part(scene, part, body.replace("/", "_"), matrix, "paminsa", bodies.color_of(body))
    if design.payload.mass > 0:
        matrix = loads.payload_transform(geometry, design.payload.mass)
        add_part(scene, fixed_part("payload"), "payload", matrix, "platform")
    for number, weight in enumerate(design.counterweights, 1):
        if weight.mass == 0:
            continue
        part = loads.counterweight(geometry, weight)
        for leg in (1, 2, 3):
            bar = f"leg{leg}_{weight.bar}"
            color = bodies.color_of(f"leg{leg}/{weight.bar}")
            add_part(scene, part, f"{bar}_weight{number}", np.eye(4), bar, color)
    return glb_bytes(scene)


def robot_files(text: str, design: Design, configuration: Configuration) -> dict[str, bytes]:
    """Return an MJCF model with meshes as files by name: ``robot.xml`` and ``meshes/*.obj``.

    Args:
        text: What `paminsa_viz.engines.mjcf` wrote for the design in the configuration.
        design: The robot; its geometry is the configuration's.
        configuration: A solved configuration of shape ().

    Raises:
        InvalidInput: If the text is of another pose or robot.
    """
    root = ET.fromstring(text)
    frames = dict(_frames(root))
    if configuration.geometry != design.geometry or configuration.pose.shape != (4,):
        raise InvalidInput("configuration", "one pose of the design's geometry is needed")
    place = place_parts(configuration)["platform"].matrix
    if PLATFORM not in frames or np.abs(frames[PLATFORM] - place).max() > 1e-9:
        raise InvalidInput("text", "it is not the design's model in the configuration")
    element = {body.attrib["name"]: body for body in root.iter("body")}
    assets, compiler = root.find("asset"), root.find("compiler")
    if assets is None or compiler is None:
        raise InvalidInput("text", "it has no assets or no compiler settings")
    compiler.set("meshdir", "meshes")
    for name, body in element.items():
        for geom in body.findall("geom"):
            if "counterweight" not in name:  # they have no meshes
                geom.set("group", CAPSULES)
    colors: dict[str, str] = {}
    files: dict[str, bytes] = {}
    for carrier, name, part, color in _shapes(design, configuration, frames):
        for material, mesh in part.merged():
            looks = material if material != ACCENT else f"accent_{color.lstrip('#')}"
            colors.setdefault(looks, SURFACES[material].color if material != ACCENT else color)
            label = f"{name}.{material}"
            path = f"meshes/{label}.obj"
            if path not in files:
                files[path] = _obj(mesh)
                # Shells: some parts are hollow or very flat, and no mass comes from them.
                ET.SubElement(assets, "mesh", name=label, file=f"{label}.obj", inertia="shell")
            attributes = {"type": "mesh", "mesh": label, "material": looks}
            ET.SubElement(element[carrier], "geom", attributes)
    for looks, color in colors.items():
        assets.append(_material(looks, color))
    _light(root, design)
    ET.indent(root)
    return {"robot.xml": (ET.tostring(root, encoding="unicode") + "\n").encode(), **files}


def _shapes(
    design: Design, configuration: Configuration, frames: Mapping[str, Array]
) -> Iterator[tuple[str, str, MeshPart, str]]:
    """Yield all shapes: the MuJoCo body that carries them, a name, the part in its frame, color.

    What has the same name has the same shape.
    """
    g = design.geometry
    places = place_parts(configuration)

    def seen(part: MeshPart, carrier: str, body: str) -> MeshPart:
        """Return a part of a drawn body in the frame of the MuJoCo body that carries it."""
        matrix = np.linalg.inv(frames[carrier]) @ places[body].matrix
        return part.moved(matrix[:3, 3], matrix[:3, :3])

    for body in bodies.STANDING:
        yield ROOT, body, bodies.make_body(g, body), bodies.color_of(body)
    for body, carrier in (("carriage", LIFT), ("platform", PLATFORM)):
        part = seen(bodies.make_body(g, body), carrier, body)
        yield carrier, body, part, bodies.color_of(body)
    for leg, color in enumerate(palette.LEG_COLORS, 1):
        for kind, link in _CARRIERS.items():
            body, carrier = f"leg{leg}/{kind}", f"leg{leg}_{link}"
            part = seen(bodies.make_body(g, body), carrier, body)
            yield carrier, kind, part, color
        swivel = f"leg{leg}/swivel"
        foot = seen(fixed_part("swivel_disc").times(g.body_scale), PLATFORM, swivel)
        yield PLATFORM, f"leg{leg}.swivel_disc", foot, color
        head = seen(fixed_part("swivel_head").times(g.body_scale), f"leg{leg}_B4", swivel)
        yield f"leg{leg}_B4", f"leg{leg}.swivel_head", head, color
    if design.payload.mass > 0:
        matrix = loads.payload_transform(g, design.payload.mass)
        drum = fixed_part("payload").moved(matrix[:3, 3], matrix[:3, :3])
        yield PLATFORM, "payload", drum, ""


def _light(root: ET.Element, design: Design) -> None:
    """Set light and view for the whole machine; capsules bear darker light than meshes."""
    visual, statistic = root.find("visual"), root.find("statistic")
    if visual is not None:
        level = {"ambient": "0.4 0.4 0.4", "diffuse": "0.45 0.45 0.45", "specular": "0.3 0.3 0.3"}
        ET.SubElement(visual, "headlight", level)
    for light in root.iterfind("worldbody/light"):
        light.set("diffuse", "0.4 0.4 0.4")
    if statistic is not None:
        machine = [bodies.make_body(design.geometry, b) for b in bodies.STANDING]
        heights = np.array([part.bounds()[:, 2] for part in machine])
        low, high = heights.min(), heights.max()
        statistic.set("center", f"0 0 {(low + high) / 2:.4g}")
        statistic.set("extent", f"{high - low:.4g}")


def _frames(root: ET.Element) -> Iterator[tuple[str, Array]]:
    """Yield name and frame (4, 4) in the world of every body, at the start."""

    def below(parent: ET.Element, frame: Array) -> Iterator[tuple[str, Array]]:
        for body in parent.findall("body"):
            here = np.eye(4)
            here[:3, 3] = _numbers(body, "pos", (0, 0, 0))
            quaternion = _numbers(body, "quat", (1, 0, 0, 0))
            here[:3, :3] = Rotation.from_quat(quaternion, scalar_first=True).as_matrix()
            yield body.attrib["name"], frame @ here
            yield from below(body, frame @ here)

    world = root.find("worldbody")
    if world is not None:
        yield from below(world, np.eye(4))


def _numbers(element: ET.Element, name: str, default: tuple[float, ...]) -> Array:
    text = element.get(name)
    return np.array(default if text is None else text.split(), dtype=float)


def _obj(mesh: trimesh.Trimesh) -> bytes:
    """Return a mesh as OBJ, with its own normals, in tenths of a micrometer."""
    text = export_obj(
        mesh, include_normals=True, include_color=False, include_texture=False, digits=7, header=""
    )
    return (cast(str, text) + "\n").encode()


def _material(name: str, color: str) -> ET.Element:
    surface = SURFACES[ACCENT if name.startswith(ACCENT) else name]
    rgba = " ".join(f"{channel / 255:.4g}" for channel in palette.rgb(color))
    return ET.Element(
        "material", name=name, rgba=f"{rgba} 1", specular=f"{0.6 * (1 - surface.roughness):.3g}",
        shininess=f"{1 - surface.roughness:.3g}", metallic=f"{surface.metallic:.3g}",
        roughness=f"{surface.roughness:.3g}",
    )  # fmt: skip
