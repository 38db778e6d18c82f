"""The whole robot in one configuration as a GLB file for other programs."""

from __future__ import annotations

import numpy as np
import trimesh

from paminsa_viz.dimensions.placement import BODIES, place_parts
from paminsa_viz.errors import InvalidInput
from paminsa_viz.meshes import bodies, loads
from paminsa_viz.meshes.library import Z_UP, fixed_part
from paminsa_viz.meshes.loads import counterweight
from paminsa_viz.meshes.part import add_part, glb_bytes
from paminsa_viz.model.design import Design
from paminsa_viz.model.kinematics import Configuration


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
        assembly=geometry.knee.value,
        pose={
            n: float(v) for n, v in zip(("x", "y", "theta", "z"), configuration.pose, strict=True)
        },
        units="m, rad",
        up="y (the node paminsa turns the base frame, in which z is up)",
    )
    scene.graph.update(frame_to="paminsa", frame_from=scene.graph.base_frame, matrix=Z_UP)
    for body in (*bodies.STANDING, *BODIES):
        if body == "ground" and not ground:
            continue
        matrix = places[body].matrix if body in places else np.eye(4)
        part = bodies.make_body(body, geometry)
        add_part(scene, part, body.replace("/", "_"), matrix, "paminsa", bodies.color_of(body))
    if design.payload.mass > 0:
        matrix = loads.payload_transform(geometry, design.payload.mass)
        add_part(scene, fixed_part("payload"), "payload", matrix, "platform")
    for number, weight in enumerate(design.counterweights, 1):
        if weight.mass == 0:
            continue
        part = counterweight(geometry, weight)
        for leg in (1, 2, 3):
            bar = f"leg{leg}_{weight.bar}"
            color = bodies.color_of(f"leg{leg}/{weight.bar}")
            add_part(scene, part, f"{bar}_weight{number}", np.eye(4), bar, color)
    return glb_bytes(scene)
