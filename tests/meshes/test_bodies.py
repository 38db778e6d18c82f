"""Bodies follow exactly the lengths that `lengths_of` names."""

from __future__ import annotations

import io
import json
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
import trimesh
from hypothesis import given, settings
from hypothesis import strategies as st

from paminsa_viz import palette
from paminsa_viz.dimensions import layers as at
from paminsa_viz.dimensions.placement import BODIES
from paminsa_viz.errors import InvalidInput
from paminsa_viz.meshes.bodies import (
    SMALL,
    STANDING,
    body_glb,
    color_of,
    lengths_of,
    make_body,
)
from paminsa_viz.meshes.part import ACCENT, SURFACES, srgb_to_linear
from paminsa_viz.meshes.solids import is_plain, plain_shapes
from paminsa_viz.model.design import APPENDIX_4, Geometry, KneeBranch
from tests.support.samples import random_design, with_knee

pytestmark = pytest.mark.slow


GEOMETRY = APPENDIX_4.geometry
ALL = (*STANDING, *BODIES)

CHANGES = {
    "magnification": 3.2, "base_radius": 0.36, "platform_radius": 0.11, "arm_length": 0.3,
    "shaft_length": 0.45, "crank_length": 0.43, "coupler_length": 0.64,
    "platform_joint_height": 0.03, "guide_link_length": 0.38, "guide_stroke": 0.3,
    "axis_clearance": 0.02, "body_scale": 0.9,
}  # fmt: skip


@cache
def outline(body: str, geometry: Geometry) -> bytes:
    """The body's shape, to the byte."""
    return b"".join(
        part.tobytes()
        for solid in make_body(geometry, body).solids
        for part in (solid.mesh.vertices, solid.mesh.faces, np.array(solid.material))
    )


@pytest.mark.parametrize("knee", list(KneeBranch))
@pytest.mark.parametrize("body", [*STANDING, *BODIES[:10]])
def test_a_body_changes_exactly_when_its_lengths_do(body: str, knee: KneeBranch) -> None:
    """By each length that it has, and not by all others together."""
    geometry = with_knee(GEOMETRY, knee)
    lengths, drawn = lengths_of(geometry, body), outline(body, geometry)
    others = {}
    for field, value in CHANGES.items():
        changed = replace(geometry, **{field: value})
        if lengths_of(changed, body) == lengths:
            others[field] = value
        else:
            assert outline(body, changed) != drawn, field
    unchanged = replace(geometry, **others)
    assert lengths_of(unchanged, body) == lengths
    assert outline(body, unchanged) == drawn


def test_a_body_changes_with_the_knee_exactly_when_its_lengths_do() -> None:
    one, other = (with_knee(GEOMETRY, knee) for knee in KneeBranch)
    for body in (*STANDING, *BODIES[:10]):
        told = lengths_of(one, body) != lengths_of(other, body)
        assert told == (outline(body, one) != outline(body, other)), body


def test_every_length_of_the_geometry_is_covered() -> None:
    assert {*CHANGES, "knee"} == set(Geometry.__dataclass_fields__)


@given(st.integers(0, 10_000), st.sampled_from(KneeBranch))
@settings(max_examples=6)
def test_any_design_can_be_drawn(seed: int, knee: KneeBranch) -> None:
    geometry = with_knee(random_design(np.random.default_rng(seed)).geometry, knee)
    for body in (*STANDING, *BODIES[:10]):
        for mesh in (solid.mesh for solid in make_body(geometry, body).solids):
            assert len(mesh.faces)
            assert np.isfinite([mesh.vertices, mesh.vertex_normals]).all()


@pytest.mark.parametrize(
    ("body", "length"),
    [
        ("leg2/b4", GEOMETRY.coupler_length), ("leg1/b8", GEOMETRY.crank_length),
        ("leg3/b7", GEOMETRY.short_coupler_length),
    ],
)  # fmt: skip
def test_a_bar_reaches_from_barrel_to_barrel(body: str, length: float) -> None:
    low, high = make_body(GEOMETRY, body).bounds()[:, 0]
    assert low == pytest.approx(-at.BARREL_RADIUS, abs=1e-9)
    assert high == pytest.approx(length + at.BARREL_RADIUS, abs=1e-9)


def test_an_arm_reaches_its_joint_and_is_as_long_as_the_design_says() -> None:
    geometry = replace(GEOMETRY, arm_length=0.2)
    carriage = make_body(geometry, "carriage")
    arms = [p.mesh for p in carriage.solids if p.material == "accent"]
    leg_3 = [m for m in arms if m.bounds[0, 1] > 0.05 and m.bounds[1, 1] < geometry.base_radius]
    assert len(leg_3) == 1
    assert leg_3[0].bounds[0, 1] == pytest.approx(geometry.base_radius - 0.2, abs=0.01)
    reach = make_body(GEOMETRY, "carriage").bounds()[1, 1]
    assert GEOMETRY.base_radius < reach < GEOMETRY.base_radius + 0.04


def test_legs_differ_in_color_alone() -> None:
    assert [color_of(f"leg{k}/b3") for k in (1, 2, 3)] == list(palette.LEG_COLORS)
    assert [color_of(f"m{k}") for k in (1, 2, 3, 4)] == list(palette.ACTUATOR_COLORS)
    assert color_of("carriage") == palette.LIFT_COLOR
    assert body_glb(GEOMETRY, "leg1/b4") != body_glb(GEOMETRY, "leg2/b4")
    assert outline("leg1/b4", GEOMETRY) == outline("leg2/b4", GEOMETRY)


def test_meshes_of_the_robot_are_below_three_megabytes() -> None:
    """About one megabyte after the transport's compression; this guards against fine meshes."""
    assert sum(len(body_glb(GEOMETRY, body)) for body in ALL) < 3_000_000


@pytest.mark.parametrize("body", ["leg4/b3", "b3", "", "leg1", "leg1/b9"])
@pytest.mark.parametrize("function", [make_body, lengths_of])
def test_unknown_body(body: str, function) -> None:
    with pytest.raises(InvalidInput, match="there is no"):
        function(GEOMETRY, body)


def test_adding_to_a_body_does_not_change_the_cached_one() -> None:
    make_body(GEOMETRY, "leg1/b8").join(make_body(GEOMETRY, "leg1/b3"))
    assert len(make_body(GEOMETRY, "leg1/b8").solids) < 40
    assert outline("leg1/b8", GEOMETRY) == outline("leg3/b8", GEOMETRY)


def test_plain_bodies_have_few_faces_and_the_same_bounds() -> None:
    faces = {True: 0, False: 0}
    for name in ALL:
        fine = make_body(GEOMETRY, name)
        with plain_shapes():
            plain = make_body(GEOMETRY, name).without_small(SMALL)
        for part, detailed in ((fine, True), (plain, False)):
            faces[detailed] += sum(len(solid.mesh.faces) for solid in part.solids)
        # Six-sided rods are a little slimmer, and bolts and glands stand out of what is left.
        np.testing.assert_allclose(plain.bounds(), fine.bounds(), atol=0.025)
    assert 3.8 * faces[False] < faces[True]


@pytest.mark.parametrize("name", ["base", "carriage", "leg2/b4", "ground"])
def test_plain_body_is_one_mesh_with_vertex_colors(name: str) -> None:
    with plain_shapes():
        part = make_body(GEOMETRY, name).without_small(SMALL)
    colors = {material: surface.color for material, surface in SURFACES.items()}
    colors[ACCENT] = color_of(name)
    wanted = {srgb_to_linear(colors[material]): len(mesh.faces) for material, mesh in part.merged()}
    glb = io.BytesIO(body_glb(GEOMETRY, name, fine=False))
    (mesh,) = trimesh.load_scene(glb, file_type="glb").geometry.values()
    assert isinstance(mesh, trimesh.Trimesh)
    assert len(mesh.faces) == sum(wanted.values())
    np.testing.assert_allclose(mesh.bounds, part.bounds(), atol=1e-6)
    shades = np.asarray(mesh.visual.vertex_attributes["color"])[mesh.faces[:, 0]] / 255
    for color, count in wanted.items():
        assert np.isclose(shades[:, :3], color, atol=2e-3).all(axis=1).sum() == count


@pytest.mark.parametrize("fine", [True, False])
def test_the_ground_shows_its_colors_unlit(fine: bool) -> None:
    for name, unlit in (("ground", True), ("base", False)):
        data = body_glb(GEOMETRY, name, fine=fine)
        tree = json.loads(data[20 : 20 + int.from_bytes(data[12:16], "little")])
        assert all(("extensions" in each) is unlit for each in tree["materials"])
        assert tree.get("extensionsUsed", []) == ["KHR_materials_unlit"] * unlit


def test_plain_shapes_do_not_leak_into_fine_ones() -> None:
    before, plain = (body_glb(GEOMETRY, "leg1/b4", fine=fine) for fine in (True, False))
    body_glb.__wrapped__.cache_clear()  # type: ignore[attr-defined]
    assert len(plain) < len(before) / 2
    assert body_glb(GEOMETRY, "leg1/b4") == before
    assert not is_plain()
