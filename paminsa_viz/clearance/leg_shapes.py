"""Solids of the bodies of one leg, and of the counterweights on its bars."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise

import numpy as np

from paminsa_viz.clearance.solids import (
    ALONG_X,
    ALONG_Y,
    OVER,
    Body,
    BodyPart,
    Primitive,
    box,
    capsule,
)
from paminsa_viz.clearance.solids import cylinder as rod
from paminsa_viz.dimensions import fixed_parts as size
from paminsa_viz.dimensions import layers as at
from paminsa_viz.dimensions.attached import disc_radius, place_along, stub
from paminsa_viz.model.design import Design, Geometry, KneeBranch
from paminsa_viz.model.parameters import BAR_ENDS, Counterweight

HUB = 0.001
"""How far a counterweight's hub protrudes from its disc [m]; counted as if the whole disc did."""

Shape = tuple[str, str, str, tuple[Primitive, ...]]
"""Key, name and frame of a body of a leg, and its solids."""


def leg_bodies(design: Design) -> Iterator[Body]:
    """Yield the bodies of all three legs with their counterweights."""
    shapes = [*_links(design.geometry), *_bars(design.geometry)]
    for leg in (1, 2, 3):
        for key, name, frame, solids in shapes:
            yield Body(key, f"{name} of leg {leg}", f"leg{leg}/{frame}", BodyPart.LEG, leg, solids)
        for number, weight in enumerate(design.counterweights, 1):
            if weight.mass <= 0:
                continue
            yield Body(
                f"counterweight{number}",
                f"counterweight {number} of leg {leg}",
                f"leg{leg}/{weight.bar}",
                BodyPart.COUNTERWEIGHT,
                leg,
                tuple(_counterweight(design.geometry, weight)),
                carrier=weight.bar,
                joints=_joints(weight.bar),
            )


def _links(g: Geometry) -> Iterator[Shape]:
    """Yield what lies in the middle of the leg plane: guide, shaft, slider, swivel."""
    length, (width, height) = g.guide_link_length, size.RAIL_HALF
    along, across, high = size.STOP
    rail = box((-length, -width, -height), (-size.RAIL_START, width, height))
    stop = box((-length - along, -across / 2, -high / 2), (-length, across / 2, high / 2))
    yield "guide", "guide B10", "guide", (rail, stop)

    block, half = size.QUILL_BLOCK
    core, top = at.CORE - 0.0005, at.QUILL_TOP
    quill = (
        rod(at.QUILL_RADIUS, size.QUILL_LOW, top),
        rod(size.QUILL_COLLAR_RADIUS, top - size.QUILL_COLLAR, top + size.QUILL_KEY),
        rod(core, -half, half),
        box((block, -core, -half), (0.0, core, half)),
    )
    if g.knee is KneeBranch.UPPER:
        quill = tuple(solid.moved(np.zeros(3), OVER) for solid in quill)
    yield "quill", "joint 1", "guide", quill

    beyond = at.ARM_BEARING_HALF + 0.004
    shaft = rod(at.SHAFT_RADIUS, size.SHAFT_LOW, g.shaft_length + beyond)
    nut_low, nut_high = size.NUT
    nut = rod(size.NUT_RADIUS, g.shaft_length + nut_low, g.shaft_length + nut_high)
    yield "shaft", "shaft B2", "shaft", (shaft, nut)

    low, high = size.SHAFT_BLOCK_HEIGHTS
    yield (
        "shaft_end",
        "joint 3",
        "shaft",
        (
            box((-size.SHAFT_BLOCK / 2, -core, low), (size.SHAFT_BLOCK / 2, core, high)),
            rod(size.SHAFT_NECK_RADIUS, high - 0.0005, size.SHAFT_NECK_TOP),
            _pin(-at.CORE + 0.0005, at.span("b3")[1], 3),
        ),
    )

    low, high = size.SLIDER_HEIGHTS
    body = box((-at.SLIDER_HALF, -at.CORE, low), (at.SLIDER_HALF, at.CORE, high))
    yield "slider", "slider", "slider", (body, _pin(at.span("b8")[0], at.span("b7")[1], 8))

    low, high = at.span("b4")
    cheek, floor = low - size.CHEEK_GAP, -at.PLATE_BELOW_5
    half, top = size.SWIVEL_HALF, floor + size.SWIVEL_DISC_HEIGHT
    head = box((-half, -cheek, floor + 0.006), (half, cheek, size.SWIVEL_TOP))
    foot = rod(size.SWIVEL_DISC_RADIUS, floor - 0.0005, top)
    yield "swivel", "joint 5", "swivel", (foot, head, _pin(-cheek, high, 5))


def _bars(g: Geometry) -> Iterator[Shape]:
    """Yield the four bars of the pantograph with the pins that they carry."""
    k, near, far = g.magnification, at.span("b4"), at.span("b3")
    b3, b4 = g.crank_length, g.coupler_length
    to_3 = b3 * (1 - 1 / k)
    pin_9 = _pin(at.span("b8")[0], near[1], 9)
    pin_4 = _pin(near[0], far[1], 4, first=False)
    pin_7 = _pin(near[0], far[1], 7, first=False)
    yield (
        "b3", "B3", "b3",
        (*_bar("b3", {4: -to_3, 3: 0.0, 7: b3 - to_3}), _placed(pin_7, b3 - to_3)),
    )  # fmt: skip
    yield (
        "b4", "B4", "b4",
        (*_bar("b4", {9: 0.0, 4: b4 / k, 5: b4}), pin_9, _placed(pin_4, b4 / k)),
    )  # fmt: skip
    yield "b7", "B7", "b7", tuple(_bar("b7", {8: 0.0, 7: g.short_coupler_length}))
    yield "b8", "B8", "b8", tuple(_bar("b8", {8: 0.0, 9: b3}))


def _bar(bar: str, stops: dict[int, float]) -> Iterator[Primitive]:
    """Yield the solids of a bar along x: tube, barrels and sockets at its joints."""
    layer, half = at.LAYER[bar], at.BARREL / 2 + size.BARREL_CAP
    places = list(stops.values())
    middle = (0.0, layer, 0.0)
    yield capsule((places[0], layer, 0.0), (places[-1], layer, 0.0), at.TUBE_RADIUS[bar])
    for joint, x in stops.items():
        yield rod(at.BARREL_RADIUS, -half, half, (x, layer, 0.0), ALONG_Y, joint)
    for x, following in pairwise(places):
        if following - x > size.SOCKETS_FROM:
            start, end = size.SOCKET
            yield rod(size.SOCKET_RADIUS, x + start, x + end, middle, ALONG_X)
            yield rod(size.SOCKET_RADIUS, following - end, following - start, middle, ALONG_X)


def _pin(low: float, high: float, joint: int, *, first: bool = True) -> Primitive:
    """Return a pin with its spacers; ``first`` says whether it has a head at the low end."""
    ends = low - (size.PIN_REACH if first else 0.0), high + size.PIN_REACH
    return rod(size.COLLAR_RADIUS, *ends, (0.0, 0.0, 0.0), ALONG_Y, joint)


def _placed(solid: Primitive, x: float) -> Primitive:
    return solid.moved(np.array([x, 0.0, 0.0]))


def _counterweight(g: Geometry, weight: Counterweight) -> Iterator[Primitive]:
    """Yield the disc of a counterweight, and the stub that carries it beyond its bar."""
    y, half = at.LAYER[weight.bar], at.BARREL / 2 + HUB
    place = (place_along(g, weight), y, 0.0)
    yield rod(disc_radius(weight.mass), -half, half, place, ALONG_Y)
    ends = stub(g, weight)
    if ends is not None:
        yield capsule((ends[0], y, 0.0), (ends[1], y, 0.0), at.TUBE_RADIUS[weight.bar])


def _joints(bar: str) -> tuple[int, ...]:
    """Return the joints on a bar, by the paper's numbers."""
    between = {"b3": (3,), "b4": (4,)}
    return (*BAR_ENDS[bar], *between.get(bar, ()))
