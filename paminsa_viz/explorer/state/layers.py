"""The registry of scene layers: switches, commands, defaults and views all come from here.

A layer is one entry and what draws it. Entries are plain data, so that the state can read the
defaults without importing the viewer; what draws them is imported when the scene is built.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any, Final, TypeAlias


@dataclass(frozen=True)
class Layer:
    """One switchable layer of the scene.

    Attributes:
        key: Name in the state; a view shows itself where `State.layers` holds it.
        label: Name on the page.
        hint: What it shows, for the switch's tooltip.
        view: What draws it, or its place in the folder ``explorer``, ``"module:name"``: a
            function that returns its nodes, see `paminsa_viz.explorer.scene.nodes.Draw`, or a class
            of views made of a `SceneContext`. Layers with the same class share one view.
        default: Whether a new session shows it.
        shortcut: Key that toggles it, or None.
        animated: Whether it moves with the robot, and so is drawn first, in every frame. The
            others are built with the rest of the page and drawn last, with the maps.
        idle: Whether what is new of it waits until nothing is dragged.
        legend: Place of a function of a `Frame`, as ``"module:name"``, that returns the color and
            the meaning of the layer's arrows, or None; empty if it has none.
        folder: Folder of its switch, see `register`.
    """

    key: str
    label: str
    hint: str
    view: str | Callable[..., Any]
    default: bool = False
    shortcut: str | None = None
    animated: bool = True
    idle: bool = False
    legend: str = ""
    folder: str = ""


LegendRow: TypeAlias = "tuple[tuple[str, ...], str] | None"
"""Colors ``#rrggbb`` of a layer's arrows and what they mean; None where there are none."""

LAYERS: Final[dict[str, Layer]] = {}
"""Every layer by its key, in the order of the page's switches."""


def register(*layers: Layer, folder: str = "Robot") -> None:
    """Add layers to the registry.

    Args:
        layers: What is added.
        folder: Folder of the panel View that their switches are in.

    Raises:
        ValueError: If a key or a shortcut is taken.
    """
    for layer in layers:
        shortcuts = {other.shortcut for other in LAYERS.values() if other.shortcut}
        if layer.key in LAYERS or layer.shortcut in shortcuts:
            raise ValueError(f"key or shortcut of layer {layer.key!r} is taken")
        LAYERS[layer.key] = replace(layer, folder=folder)


def default_layers() -> frozenset[str]:
    """Return the keys of the layers that a new session shows."""
    return frozenset(layer.key for layer in LAYERS.values() if layer.default)


def with_layers(shown: frozenset[str], visible: dict[str, bool]) -> frozenset[str]:
    """Return the keys of the shown layers after some have been switched.

    Raises:
        KeyError: If there is no such layer.
    """
    for key in visible:
        LAYERS[key]
    on = {key for key, is_on in visible.items() if is_on}
    return (shown | on) - (visible.keys() - on)


_FLOOR = "features.maps.floor:FloorMap"

register(
    Layer("mesh", "Robot", "The machine itself", "scene.bodies:Bodies", default=True),
    Layer(
        "skeleton", "Skeleton", "Bars as lines, with the paper’s joint numbers",
        "scene.mechanism:skeleton", shortcut="K",
    ),
    Layer(
        "mass_centers", "Mass centers", "A ball for each mass, its volume in proportion",
        "scene.mechanism:mass_balls", shortcut="C",
    ),
    Layer("springs", "Springs", "Springs that were fitted in the section Balance",
          "features.springs.layers:fitted_springs", default=True),
    Layer("labels", "Labels", "Names of the actuators", "scene.actuators:actuator_labels",
          default=True),
    Layer(
        "fine", "Fine detail",
        "Round edges and bolts; on by default where there is a graphics card",
        "scene.bodies:Bodies",
    ),
    Layer(
        "shadows", "Shadows", "Shadows and reflections; slow without a graphics card",
        "scene.stage:Stage"
    ),
    Layer(
        "gizmo", "Platform handle", "Drag the platform in the scene", "scene.pose_handles:Gizmo",
        shortcut="G",
    ),
    Layer("pinned_design", "Pinned design",
          "Translucent: the reference at the same pose, where its shape differs",
          "features.compare.layers:PinnedDesign", default=True),
    Layer("best_so_far", "Best robot so far", "Of the search of the section Synthesis, as lines",
          "features.synthesis.layers:best_robot", default=True),
    folder="Robot",
)  # fmt: skip

register(
    Layer("gravity", "Weights", "The weight of each body as an arrow", "scene.mechanism:weights",
          legend="scene.mechanism:weights_meaning"),
    Layer(
        "torques", "Actuator torques", "Static torques as arrows about the leg axes, and F₄",
        "scene.actuators:torque_arrows", default=True, legend="scene.actuators:torques_meaning",
    ),
    Layer("load", "Load", "The external force and moment, to a stated scale",
          "scene.forces:load_arrows", default=True, legend="scene.forces:load_meaning"),
    Layer("force_polygon", "Force polygon",
          "Horizontal forces that the actuators hold with no moment", "scene.forces:force_polygon"),
    Layer("wrench_solid", "Wrench polytope",
          "Horizontal forces and M_z / R_pl that the actuators hold", "scene.forces:wrench_solid"),
    Layer("joint_forces", "Joint forces",
          "Forces at the joints in the legs’ planes, at rest or of the motion, to a stated scale",
          "features.loads.layers:joint_arrows", legend="features.loads.layers:arrows_meaning"),
    Layer("utilization", "Bars by load", "Stress of the bars over the yield stress",
          "features.loads.layers:bar_sleeves"),
    folder="Forces",
)  # fmt: skip

register(
    Layer(
        "floor_map", "Floor map", "The chosen map, under the robot; click it to go there", _FLOOR,
        default=True, shortcut="F", animated=False,
    ),
    Layer(
        "workspace", "Workspace boundary", "Positions within reach at the current θ and z", _FLOOR,
        default=True, animated=False,
    ),
    Layer(
        "singularity", "Singular circle", "Where the platform escapes the actuators at this θ",
        _FLOOR, default=True, animated=False,
    ),
    Layer("volume", "Volume of requirements",
          "Where all requirements hold, colored by what ends it there",
          "features.requirements.layers:volume",
          default=True, animated=False, idle=True),
    Layer("required_workspace", "Required workspace", "Its outline",
          "features.requirements.layers:required_workspace", default=True, animated=False),
    Layer("proven_workspace", "Proven workspace",
          "Outline of the largest one, see the section Requirements",
          "features.requirements.layers:proven_workspace", default=True, animated=False),
    Layer("joint_limits", "Joint limits",
          "Sectors: from where to where each θ turns over the poses that count; lines: the travel "
          "of joint 8 on its guide", "features.pose.layers:JointLimits"),
    folder="Ground and workspace",
)  # fmt: skip

register(
    Layer("path", "Path of the motion", "Colored by torque, and on the maps",
          "features.motion.layers:motion_path"),
    Layer("points", "Points of the motion",
          "The poses that a motion is built from: click one, then drag it",
          "features.motion.handles:MotionPoints"),
    Layer("wanted_pose", "Wanted pose",
          "Translucent: where the robot should be, while its simulation is played",
          "features.motion.layers:WantedPose", default=True),
    Layer(
        "escape_twist", "Escape twist",
        "Where the motion crosses a singularity: the platform’s motion that no actuator feels",
        "features.motion.escape:escape_arrows", default=True,
        legend="features.motion.escape:escape_meaning",
    ),
    folder="Motion",
)  # fmt: skip

register(
    Layer("mode_shape", "Mode shape", "The natural mode chosen in the section Stiffness, animated",
          "features.stiffness.layers:mode_shape", idle=True),
    Layer("deflection", "Deflection",
          "Displaced by the load case of the section Stiffness, enlarged",
          "features.stiffness.layers:deflection"),
    Layer("compliance", "Compliance ellipsoid", "Displacements by a force in every direction",
          "features.stiffness.layers:compliance"),
    Layer("drive_errors", "Drive errors",
          "Where the platform’s center may be within the drives’ errors, to a stated scale",
          "features.accuracy.layers:drive_error_nodes"),
    Layer("contacts", "Contacts", "Where bars would touch, their center lines in the leg’s plane",
          "features.clearance.layers:contact_marks"),
    Layer("clearance", "Clearance", "The two nearest bodies, and their distance",
          "features.clearance.layers:nearest_bodies"),
    folder="Deformation and errors",
)  # fmt: skip
