"""The mechanism as a stick figure with the paper's joint numbers, and its mass centers."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from paminsa_viz import palette
from paminsa_viz.dimensions.attached import payload_center
from paminsa_viz.explorer.core.frame import Frame
from paminsa_viz.explorer.scene.curves import linear_colors
from paminsa_viz.explorer.scene.forces import scale_text
from paminsa_viz.explorer.scene.nodes import Node, arrows, ball, copies, label, lines
from paminsa_viz.explorer.scene.sizes import symbol_size
from paminsa_viz.explorer.state.layers import LegendRow
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.design import Design
from paminsa_viz.model.elastic import BARS
from paminsa_viz.model.kinematics import Configuration
from paminsa_viz.model.leg_points import bar_length
from paminsa_viz.model.parameters import LEG_JOINTS, Counterweight

ENDS: Final = {"b4": (9, 5), "b3": (4, 7), "b7": (8, 7), "b8": (8, 9), "b2": (3, 2)}
"""End joints of the bars, in the order drawn; a bar's mass center is midway between them."""

DOT: Final = 0.0085
"""Radius of a joint's dot beside the prototype's bodies [m]."""

NUMBER_SIZE: Final = (16.0, 20.0)
"""Width and height of a joint's number on the screen [px]."""


def plane_directions(configuration: Configuration) -> tuple[Array, Array]:
    """Return the directions of the legs' planes, and those across them, (3, 3) each."""
    c, s, zero = np.cos(configuration.beta), np.sin(configuration.beta), np.zeros(3)
    return np.stack([c, s, zero], axis=-1), np.stack([-s, c, zero], axis=-1)


def directions(configuration: Configuration) -> tuple[Array, Array, Array]:
    """Return the legs' axes, (3, 3) [m], and the directions of their arms and of their planes."""
    axis = configuration.points[2] * [1.0, 1.0, 0.0]
    heading, _ = plane_directions(configuration)
    return axis, axis / configuration.geometry.base_radius, heading


def sticks(configuration: Configuration) -> Array:
    """Return the stick figure's lines, (3 legs, 9, 2 ends, 3) [m].

    In this order: B4, B3, B7, B8, B2; arm B1; guide link B10; joint 5 to the platform's plane (B5);
    an edge of the platform.
    """
    points, geometry = configuration.points, configuration.geometry
    axis, outward, heading = directions(configuration)
    arm = points[2] - geometry.arm_length * outward
    guide = axis - geometry.guide_link_length * heading
    below = points[5].copy()
    below[:, 2] = configuration.pose[3]
    bars = [np.stack([points[a], points[b]], axis=1) for a, b in ENDS.values()]
    bars += [
        np.stack(pair, axis=1)
        for pair in (
            (arm, points[2]), (axis, guide), (points[5], below), (below, np.roll(below, 1, axis=0)),
        )
    ]  # fmt: skip
    return np.stack(bars, axis=1)


def stick_colors() -> NDArray[np.uint8]:
    """Return the colors of `sticks`, (3, 9, 2, 3)."""
    legs = linear_colors(*palette.LEG_COLORS)
    out = np.broadcast_to(legs[:, None, None, :], (3, 9, 2, 3)).copy()
    out[:, 4:6] = linear_colors(palette.LIFT_COLOR)
    out[:, 6:] = linear_colors(palette.MUTED)
    return out


def skeleton(frame: Frame) -> Iterator[Node]:
    """Draw the layer ``skeleton``: stick figure and joint numbers."""
    if not frame.drawable:
        return
    points, scale = frame.configuration.points, frame.configuration.geometry.body_scale
    bars = sticks(frame.configuration).reshape(-1, 2, 3)
    yield lines("/skeleton/lines", bars, stick_colors().reshape(-1, 2, 3), 3.5)
    joints = np.stack([points[joint] for joint in LEG_JOINTS], axis=1)
    colors = linear_colors(*palette.LEG_COLORS).repeat(len(LEG_JOINTS), axis=0)
    places = joints.reshape(-1, 3)
    yield copies(
        "/skeleton/dots", ball(DOT), places, batched_colors=colors,
        batched_scales=np.full(len(places), scale, np.float32),
    )  # fmt: skip
    for leg, places in enumerate(joints, 1):
        for joint, place in zip(LEG_JOINTS, places, strict=True):
            name = f"/skeleton/numbers/{leg}/{joint}"
            yield label(name, str(joint), place, "bottom-left", 0.95, spaced=NUMBER_SIZE)


BALL: Final = 0.0225
"""Radius of the sphere of 1 kg [m]."""

ARROW_PER_NEWTON: Final = 0.010
LONGEST_ARROW: Final = 0.30
SHORTEST_ARROW: Final = 0.020
"""Length of a gravity arrow [m/N], and its bounds at Appendix 4's lengths [m]."""


class PointMasses(NamedTuple):
    """Mass centers (n, 3) [m], masses (n,) [kg] and colors (n, 3)."""

    center: Array
    mass: Array
    color: NDArray[np.uint8]


def mass_centers(design: Design, configuration: Configuration) -> PointMasses:
    """Return every mass that the statics know, where it is in a configuration of shape ().

    Legs 1, 2, 3 in turn (joints 2, 3, 4, 5, 7, 8, 9, then links B1, B2, B3, B4, B7, B8, B10), then
    the platform and the payload, then the counterweights of leg 1, of leg 2, of leg 3.
    """
    geometry, points = configuration.geometry, configuration.points
    axis, outward, heading = directions(configuration)
    centers = [points[joint] for joint in LEG_JOINTS]
    masses = [getattr(design.joints, f"j{joint}") for joint in LEG_JOINTS]
    for link in BARS:
        if link == "b1":
            centers.append(points[2] - geometry.arm_length / 2 * outward)
        elif link == "b10":
            centers.append(axis - geometry.guide_link_length / 2 * heading)
        else:
            a, b = ENDS[link]
            centers.append((points[a] + points[b]) / 2)
        masses.append(getattr(design.links, link))
    legs = np.stack(centers, axis=1).reshape(-1, 3)
    x, y, _, z = configuration.pose
    platform = np.array([x, y, z])
    load = platform + payload_center(geometry, design.payload.mass)
    leg_colors = linear_colors(*palette.LEG_COLORS)
    ends = linear_colors(palette.INK, palette.WARN)
    added = design.counterweights
    attached = [_counterweight_places(configuration, weight) for weight in added]
    places = np.stack(attached, axis=1).reshape(-1, 3) if attached else np.empty((0, 3))
    return PointMasses(
        np.vstack([legs, platform, load, places]),
        np.array(
            [*masses * 3, design.platform.mass, design.payload.mass, *[w.mass for w in added] * 3]
        ),
        np.vstack(
            [leg_colors.repeat(len(masses), axis=0), ends, leg_colors.repeat(len(attached), axis=0)]
        ),
    )


def _counterweight_places(configuration: Configuration, weight: Counterweight) -> Array:
    """Return where a counterweight is on the three legs, (3, 3) [m]."""
    near, far = configuration.points[weight.joint], configuration.points[weight.other]
    return near + weight.beyond / bar_length(configuration.geometry, weight.bar) * (near - far)


def newtons_per_bar(points: PointMasses, gravity: float, size: float = 1.0) -> float:
    """Return the weight that 100 mm of an arrow stand for [N], for symbols of a size.

    One scale for all robots, but where the heaviest mass would have an arrow that is too long, or
    all would have the shortest one, as those of grams.
    """
    heaviest = float((points.mass * gravity).max(initial=0.0))
    fitted = heaviest / (size * LONGEST_ARROW)
    tiny = 0.0 < heaviest * ARROW_PER_NEWTON < size * SHORTEST_ARROW
    return 0.1 * (fitted if tiny else max(1 / ARROW_PER_NEWTON, fitted))


def gravity_arrows(points: PointMasses, gravity: float, size: float = 1.0) -> Array:
    """Return arrows from the mass centers downward, (n, 2, 3) [m], their length by the weight."""
    weight = points.mass * gravity
    length = weight * 0.1 / newtons_per_bar(points, gravity, size)
    length = np.where(weight > 0, np.maximum(length, size * SHORTEST_ARROW), 0.0)
    tips = points.center.copy()
    tips[:, 2] -= length
    return np.stack([points.center, tips], axis=1)


def mass_balls(frame: Frame) -> Iterator[Node]:
    """Draw the layer ``mass_centers``."""
    if frame.drawable:
        points = mass_centers(frame.shown_design, frame.configuration)
        scales = np.cbrt(points.mass).astype(np.float32)
        yield copies(
            "/masses/centers", ball(BALL), points.center, batched_scales=scales,
            batched_colors=points.color,
        )  # fmt: skip


def weights(frame: Frame) -> Iterator[Node]:
    """Draw the layer ``gravity``."""
    if frame.drawable:
        points = mass_centers(frame.shown_design, frame.configuration)
        size = symbol_size(frame.shown_design.geometry)
        found = gravity_arrows(points, frame.shown_design.gravity, size)
        sizes = (0.0028, 0.0075, 0.018)
        yield arrows("/masses/gravity", found, frame.state.theme.ink, sizes, size)


def weights_meaning(frame: Frame) -> LegendRow:
    """Explain the arrows of the bodies' weights."""
    design = frame.shown_design
    if not np.isfinite(frame.configuration.pose).all() or not frame.drawable:
        return None
    points, size = mass_centers(design, frame.configuration), symbol_size(design.geometry)
    scale = newtons_per_bar(points, design.gravity, size)
    return (palette.INK,), f"weights, {scale_text(scale, size)}"
