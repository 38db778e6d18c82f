"""Solids enclose what is drawn, and touch it."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from itertools import product
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from paminsa_viz.clearance.frame_shapes import _arm
from paminsa_viz.clearance.nearest import BOX, CAPSULE, CYLINDER, PRISM
from paminsa_viz.clearance.shapes import _common_rod, shapes_of
from paminsa_viz.clearance.solids import (
    WORLD,
    Body,
    BodyPart,
    Primitive,
    box,
    capsule,
    cylinder,
    prism,
)
from paminsa_viz.dimensions import fixed_parts as size
from paminsa_viz.dimensions.layout import ring_arcs
from paminsa_viz.dimensions.placement import BODIES, place_parts
from paminsa_viz.meshes import bodies as drawn
from paminsa_viz.meshes import loads
from paminsa_viz.meshes.part import MeshPart, fixed_part
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.design import APPENDIX_4, Counterweight, Design, KneeBranch, Payload
from paminsa_viz.model.kinematics import inverse_kinematics
from paminsa_viz.model.parameters import BAR_ENDS
from tests.clearance.pairs_of_solids import outside, random_solid
from tests.support.samples import random_design, with_knee

LEFT_OUT = {"ground": 0.0007, "base": 0.0005, "slider": 0.00015}
"""What thin details protrude by: lines on the ground, inlays of the mast, wipers [m]."""


def vertices(part: MeshPart) -> Array:
    return np.vstack([solid.mesh.vertices for solid in part.solids])


def surface(part: MeshPart) -> Array:
    """Return vertices, and places on every triangle: middles of its edges, its own middle."""
    shares = np.array([(1, 1, 0), (0, 1, 1), (1, 0, 1), (2 / 3, 2 / 3, 2 / 3)]) / 2
    triangles = np.vstack([solid.mesh.triangles for solid in part.solids])
    between = np.einsum("sk,tkx->tsx", shares, triangles).reshape(-1, 3)
    return np.vstack([vertices(part), between])


def loaded(geometry_seed: int | None, knee: KneeBranch) -> Design:
    weights = (Counterweight("b8", 8, 0.2, 2.0), Counterweight("b4", 9, -0.1, 1.0))
    if geometry_seed is None:
        design = replace(APPENDIX_4, geometry=with_knee(APPENDIX_4.geometry, knee))
    else:
        design = with_knee(random_design(np.random.default_rng(geometry_seed)), knee)
    return replace(design, payload=Payload(mass=3.0), counterweights=weights)


def beyond(body: Body, points: Array) -> Array:
    """Return how far points (..., 3) of a body's frame are outside of all its solids (...) [m]."""
    return np.min([outside(solid, points) for solid in body.solids], axis=0)


def of_frame(design: Design, frame: str) -> list[Body]:
    hung = (BodyPart.PAYLOAD, BodyPart.COUNTERWEIGHT)
    return [b for b in shapes_of(design).bodies if b.frame == frame and b.part not in hung]


@pytest.mark.slow
@pytest.mark.parametrize("seed", [None, 1])
@pytest.mark.parametrize("knee", list(KneeBranch))
def test_solids_enclose_the_surface_that_is_drawn(knee: KneeBranch, seed: int | None) -> None:
    design = loaded(seed, knee)
    for name in (*drawn.STANDING, *BODIES):
        bodies = of_frame(design, WORLD if name in drawn.STANDING else name)
        if name.startswith(("leg2/", "leg3/")):  # whose bodies are drawn alike as well
            same = of_frame(design, f"leg1/{name[5:]}")
            assert [body.solids for body in bodies] == [body.solids for body in same]
            continue
        points = surface(drawn.make_body(design.geometry, name))
        distance = np.min([beyond(body, points) for body in bodies], axis=0)
        allowed = LEFT_OUT.get(name.rpartition("/")[2], 1e-6)
        assert distance.max() < allowed, name


@pytest.mark.parametrize("knee", list(KneeBranch))
def test_payload_and_counterweights_are_enclosed(knee: KneeBranch) -> None:
    design = loaded(None, knee)
    matrix = loads.payload_transform(design.geometry, design.payload.mass)
    drum = surface(fixed_part("payload").moved(matrix[:3, 3], matrix[:3, :3]))
    bodies = shapes_of(design).bodies
    payload = next(body for body in bodies if body.part is BodyPart.PAYLOAD)
    assert beyond(payload, drum).max() < 1e-6
    assert max(loose(payload.solids[0], drum).values()) < 1e-6
    for number, weight in enumerate(design.counterweights, 1):
        points = surface(loads.counterweight(design.geometry, weight))
        body = next(b for b in bodies if b.name == f"counterweight {number} of leg 2")
        assert body.frame == f"leg2/{weight.bar}"
        assert beyond(body, points).max() < 1e-6
        assert max(max(loose(solid, points).values()) for solid in body.solids) < 1e-6


def loose(solid: Primitive, points: Array) -> dict[str, float]:
    """How far the faces of a solid are from the drawn points in it: its round side and both ends.

    Of a capsule its round side alone, whose ends are in what is around its joints; of a box and a
    prism every side.
    """
    p = (points[outside(solid, points) < 1e-6] - solid.center) @ solid.rotation
    if solid.kind == CAPSULE:
        p = p[np.abs(p[:, 2]) <= solid.size[2]]
        return {"side": solid.radius - np.hypot(p[:, 0], p[:, 1]).max()}
    found = {"top": solid.size[2] - p[:, 2].max(), "bottom": solid.size[2] + p[:, 2].min()}
    if solid.kind == CYLINDER:
        return found | {"side": solid.size[0] - np.hypot(p[:, 0], p[:, 1]).max()}
    corners = solid.corners
    if solid.kind == BOX:
        corners = np.array([(1, 1), (-1, 1), (-1, -1), (1, -1)]) * solid.size[:2]
    edges = np.roll(corners, -1, axis=0) - corners
    normals = np.stack([edges[:, 1], -edges[:, 0]], axis=1)
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    free = np.sum(normals * corners, axis=1) - (p[:, :2] @ normals.T).max(axis=0)
    return found | {f"side {k}": gap for k, gap in enumerate(free)}


SET_BACK = {
    "the base plate": 3e-4,  # seats of the motors, rounded below
    "the platform": 1e-4,  # rounded between its arms
    "guide B10": 1e-3,  # the rail, up to its stop
    "slider": 4e-3,  # with its wipers
}
"""What a face of a body may be away from what is drawn in its solid; others touch it [m]."""


@pytest.mark.slow
@pytest.mark.parametrize(
    ("knee", "seed"), [(KneeBranch.LOWER, None), (KneeBranch.LOWER, 1), (KneeBranch.UPPER, 1)]
)
def test_solids_are_no_larger_than_what_is_drawn_in_them(knee: KneeBranch, seed: int) -> None:
    """Every face touches the drawn surface; the ring of the base plate is looked at below.

    The arms of robot 1 have a neck, those of the prototype have none.
    """
    design = loaded(seed, knee)
    standing = np.vstack([vertices(drawn.make_body(design.geometry, n)) for n in drawn.STANDING])
    for frame in (WORLD, *BODIES):
        world = frame == WORLD
        points = standing if world else vertices(drawn.make_body(design.geometry, frame))
        for body in of_frame(design, frame):
            allowed = SET_BACK.get(body.name.partition(" of leg")[0], 1e-6)
            for number, solid in enumerate(body.solids):
                if world and body.key == "base" and number in RING:
                    continue
                gaps = loose(solid, points)
                assert max(gaps.values()) < allowed * (1 + 1e-2), (body.name, number, gaps)


def test_arms_have_a_neck_and_a_beam_where_there_is_room_for_them() -> None:
    """From the carriage's surface on, and between the overlap at the root and joint 2."""
    radius, away = size.CARRIAGE_RADIUS, 1.0
    for root, neck in ((radius, False), (float(np.nextafter(radius, 1.0)), True)):
        kinds = [solid.kind for solid in _arm(root, 0.0)]
        assert (BOX in kinds) == neck
    shortest = next(  # the beam begins where it ends, to the last bit
        length
        for length in size.ARM_END - size.ARM_OVERLAP + np.arange(-9, 10) * 1e-17
        if (away - length) - size.ARM_OVERLAP == away - size.ARM_END
    )
    for length, beam in ((shortest, False), (shortest + 1e-9, True)):
        assert (PRISM in [solid.kind for solid in _arm(away, length)]) == beam


RING = range(7, 31)
"""Solids of the base plate that are its ring, after hub, spokes and seats."""


@pytest.mark.parametrize("knee", list(KneeBranch))
def test_boxes_of_the_ring_follow_each_other_about_what_is_drawn(knee: KneeBranch) -> None:
    """Eight for each of its arcs, outer corner to outer corner; inside they touch its chords."""
    design = loaded(None, knee)
    solids = [of_frame(design, WORLD)[0].solids[number] for number in RING]
    radius, half = design.geometry.base_radius, size.RING_WIDTH / 2
    ends = []
    for solid in solids:
        x, y, _ = solid.size
        corners = solid.center + np.array([(x, -y, 0), (x, y, 0)]) @ solid.rotation.T
        ends.append(np.arctan2(corners[:, 1], corners[:, 0]))
        step = 2 * np.arctan2(y, np.hypot(*solid.center[:2]) + x)
        assert np.hypot(*solid.center[:2]) + x == pytest.approx(radius + half)
        # nearest along the middle of the box is the middle of a chord at its ends
        along = np.cos(np.linspace(-step / 2, step / 2, 101)).min()
        nearest = (radius - half) * np.cos(size.RING_STEP / 2) * along
        assert np.hypot(*solid.center[:2]) - x == pytest.approx(nearest, abs=1e-12)
    for arc, (first, last) in enumerate(ring_arcs(radius)):
        own = np.array(ends[8 * arc : 8 * arc + 8])
        around = np.array([first, last])
        np.testing.assert_allclose(np.cos(own[[0, -1], [0, 1]] - around), 1.0, atol=1e-12)
        np.testing.assert_allclose(np.cos(own[1:, 0] - own[:-1, 1]), 1.0, atol=1e-12)
    assert len(RING) == 8 * len(list(ring_arcs(radius)))


def test_pins_go_through_what_is_mounted_around_their_joint() -> None:
    """The platform around joints 5; a counterweight around the joints at the ends of its bar."""
    weights = tuple(Counterweight(bar, joints[0], 0.1, 1.0) for bar, joints in BAR_ENDS.items())
    bodies = shapes_of(replace(APPENDIX_4, counterweights=weights)).bodies
    points = inverse_kinematics(APPENDIX_4.geometry, (0.02, 0.01, 0.1, -0.5)).points
    mounted = [body for body in bodies if body.part is BodyPart.COUNTERWEIGHT]
    assert len(mounted) == 3 * len(weights)
    for body in mounted:
        first, last = (points[joint][0] for joint in BAR_ENDS[body.frame.rpartition("/")[2]])
        length = np.linalg.norm(last - first)
        detour = {
            joint: np.linalg.norm(at[0] - first) + np.linalg.norm(last - at[0]) - length
            for joint, at in points.items()
        }
        assert set(body.joints) == {joint for joint, more in detour.items() if more < 1e-9}
    around = {body.key: body.joints for body in bodies if body.joints}
    assert {k: v for k, v in around.items() if "weight" not in k} == {"platform": (5,)}


@pytest.mark.parametrize("knee", list(KneeBranch))
def test_what_goes_around_a_joint_is_at_that_joint(knee: KneeBranch) -> None:
    """In the plane of its leg; beside it are the layers of the bars."""
    design = with_knee(APPENDIX_4, knee)
    pose = (0.02, 0.01, 0.1, -0.5 if knee is KneeBranch.LOWER else 0.45)
    configuration = inverse_kinematics(design.geometry, pose)
    places, seen = place_parts(configuration), set()
    for body in shapes_of(design).bodies:
        for solid in body.solids:
            if solid.joint:
                matrix = places[body.frame].matrix
                center = matrix[:3, :3] @ solid.center + matrix[:3, 3]
                beta = configuration.beta[body.leg - 1]
                aside = np.array([-np.sin(beta), np.cos(beta), 0.0])
                off = center - configuration.points[solid.joint][body.leg - 1]
                np.testing.assert_allclose(off - (off @ aside) * aside, 0.0, atol=1e-12)
                seen.add((body.key, solid.joint))
    around = {"b3": (3, 4, 7), "b4": (4, 5, 9), "b7": (7, 8), "b8": (8, 9)}
    around |= {"shaft_end": (3,), "slider": (8,), "swivel": (5,)}
    assert seen == {(key, joint) for key, joints in around.items() for joint in joints}


def test_shapes_follow_from_geometry_payload_and_counterweights_alone() -> None:
    shapes = shapes_of(APPENDIX_4)
    assert shapes_of(APPENDIX_4.vary({"links.b3": 3.0, "gravity": 1.0})) is shapes
    assert shapes_of(APPENDIX_4.vary({"payload.mass": 1.0})) is not shapes


def places_on(solid: Primitive, rng: np.random.Generator) -> Any:
    """Points on the surface of a solid, in its body's frame, (n, 3); its extreme ones nearly."""
    turn = rng.uniform(0.0, 2 * np.pi, 20_000)
    if solid.kind == PRISM:
        own = np.concatenate([np.insert(solid.corners, 2, end, axis=1) for end in (-1, 1)])
        own[:, 2] *= solid.size[2]
    elif solid.kind == BOX:
        own = np.array(list(product((-1, 1), repeat=3))) * solid.size
    elif solid.kind == CYLINDER:
        own = np.stack([np.cos(turn), np.sin(turn), rng.choice([-1, 1], len(turn))], axis=1)
        own = own * solid.size
    else:
        up = rng.uniform(-1.0, 1.0, len(turn))
        across = np.sqrt(1 - up**2)
        own = solid.radius * np.stack([across * np.cos(turn), across * np.sin(turn), up], axis=1)
        own[:, 2] += np.sign(up) * solid.size[2]
    return own @ solid.rotation.T + solid.center


def test_solids_are_made_where_and_as_large_as_they_are_said_to_be() -> None:
    rng = np.random.default_rng(0)
    turn = Rotation.random(random_state=0).as_matrix()
    corners = np.array([(0.2, 0.0), (0.1, 0.3), (-0.1, -0.05)])
    for _ in range(5):
        low, high = np.sort(rng.uniform(-1.0, 1.0, (2, 3)), axis=0)
        middle, half = (low + high) / 2, (high - low) / 2
        bar = capsule(low, high, 0.05)
        assert bar.size == pytest.approx([0.0, 0.0, np.linalg.norm(half)])
        ends = bar.center + bar.size[2] * np.outer([-1, 1], bar.rotation[:, 2])
        np.testing.assert_allclose(ends, [low, high], atol=1e-15)
        block = box(low, high, turn)
        np.testing.assert_allclose([*block.size, *block.center], [*half, *turn @ middle])
        round_one = cylinder(0.3, low[2], high[2], low, turn, 7)
        np.testing.assert_allclose(round_one.size, [0.3, 0.3, half[2]])
        np.testing.assert_allclose(round_one.center, low + middle[2] * turn[:, 2])
        flat = prism(corners, low[2], high[2], turn)
        np.testing.assert_allclose(flat.size, [0.2, 0.3, half[2]])
        np.testing.assert_allclose(flat.center, middle[2] * turn[:, 2])
        assert (bar.radius, bar.joint, round_one.joint) == (0.05, 0, 7)
        for solid in (block, round_one, flat):
            assert solid.radius == 0.0
            np.testing.assert_array_equal(solid.rotation, turn)
        proper([bar, block, round_one, flat])
    ball = capsule(low, low, 0.1)
    assert ball.size.tolist() == [0.0, 0.0, 0.0]
    assert ball.rotation[:, 2].tolist() == [0.0, 0.0, 1.0]
    proper([ball])


def proper(solids: Iterable[Primitive]) -> None:
    """Check that rotations turn, and mirror nothing."""
    turns = np.array([solid.rotation for solid in solids])
    np.testing.assert_allclose(turns @ turns.swapaxes(1, 2), np.tile(np.eye(3), (len(turns), 1, 1)),
                               atol=1e-12)  # fmt: skip
    np.testing.assert_allclose(np.linalg.det(turns), 1.0, atol=1e-12)


@pytest.mark.parametrize("knee", list(KneeBranch))
def test_no_solid_of_the_robot_is_mirrored(knee: KneeBranch) -> None:
    proper(solid for body in shapes_of(loaded(None, knee)).bodies for solid in body.solids)


@pytest.mark.parametrize("kind", ["capsule", "box", "cylinder", "prism"])
@pytest.mark.parametrize("seed", range(4))
def test_extent_and_rod_of_a_turned_solid_hold_its_surface(kind: str, seed: int) -> None:
    rng = np.random.default_rng(seed)
    turn = Rotation.random(random_state=seed).as_matrix()
    solid = random_solid(kind, rng).moved(rng.uniform(-1.0, 1.0, 3), turn)
    points = places_on(solid, rng)
    low, high = points.min(axis=0), points.max(axis=0)
    size = np.ptp(points, axis=0).max()
    assert np.all(solid.extent[0] <= low + 1e-12)
    assert np.all(solid.extent[1] >= high - 1e-12)
    np.testing.assert_allclose(solid.extent, [low, high], atol=1e-3 * size)  # and not much more
    begin, end, radius = solid.rod[:3], solid.rod[3:6], solid.rod[6]
    along = end - begin
    share = np.clip((points - begin) @ along / max(along @ along, 1e-30), 0.0, 1.0)
    off = np.linalg.norm(points - begin - share[:, None] * along, axis=1)
    assert off.max() <= radius + 1e-12
    if kind != "prism":  # whose corners are not all as far out as its half sides
        assert off.max() >= radius * (1 - 1e-3)


def test_the_capsule_about_a_body_lies_along_its_longest_solid() -> None:
    """A bar with a pin across: as long as the bar, and as wide as the pin reaches."""
    bar = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.01]
    pin = [0.3, -0.02, 0.0, 0.3, 0.05, 0.0, 0.004]
    for order in ([bar, pin], [pin, bar]):
        rod = _common_rod(np.array(order))
        assert sorted([rod[0], rod[3]]) == pytest.approx([0.0, 1.0])
        assert [*rod[1:3], *rod[4:6]] == pytest.approx([0.0] * 4)
        assert rod[6] == pytest.approx(0.05 + 0.004)
    balls = np.array([[0.1, 0.2, 0.3] * 2 + [0.05], [0.1, 0.2, 0.7] * 2 + [0.02]])
    about = _common_rod(balls)
    assert sorted([about[2], about[5]]) == pytest.approx([0.3, 0.7])
    assert about[6] == pytest.approx(0.05)


def test_solids_of_a_body_that_meet_reach_half_a_millimeter_into_each_other() -> None:
    """Between the block of joint 3 and the neck on it, in the quill, and under joint 5's head."""
    bodies = {body.name: body.solids for body in shapes_of(APPENDIX_4).bodies}
    block, neck, _ = bodies["joint 3 of leg 1"]
    assert block.extent[1, 2] - neck.extent[0, 2] == pytest.approx(5e-4)
    _, _, core, _ = bodies["joint 1 of leg 1"]
    slider = bodies["slider of leg 1"][0]
    assert slider.extent[1, 1] - core.extent[1, 1] == pytest.approx(5e-4)
    foot, head, _ = bodies["joint 5 of leg 1"]
    assert head.extent[0, 2] - foot.extent[0, 2] == pytest.approx(6.5e-3)
