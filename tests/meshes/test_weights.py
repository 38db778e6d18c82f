"""Counterweights: placed as in the mechanics, with volumes in proportion to their masses."""

from __future__ import annotations

import io
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
import trimesh
from hypothesis import given
from hypothesis import strategies as st

from paminsa_viz.blocks.balance import room_text
from paminsa_viz.dimensions import layers as at
from paminsa_viz.dimensions.attached import STEEL, disc_radius, place_along
from paminsa_viz.dimensions.placement import place_parts
from paminsa_viz.meshes import assemble_glb
from paminsa_viz.meshes.loads import counterweight
from paminsa_viz.model.design import APPENDIX_4, KneeBranch
from paminsa_viz.model.kinematics import inverse_kinematics
from paminsa_viz.model.parameters import BAR_ENDS, Counterweight
from tests.support.samples import random_design, random_poses, with_knee

ENDS = [(bar, end) for bar, ends in BAR_ENDS.items() for end in ends]


@given(st.integers(0, 1000), st.sampled_from(ENDS), st.floats(-0.3, 0.3))
def test_a_counterweight_is_placed_from_its_joint(
    seed: int, end: tuple[str, int], beyond: float
) -> None:
    rng = np.random.default_rng(seed)
    design = random_design(rng)
    configuration = inverse_kinematics(design.geometry, random_poses(rng, design)[0])
    weight = Counterweight(*end, beyond, 1.0)
    near, far = (configuration.points[joint] for joint in (weight.joint, weight.other))
    places = place_parts(configuration)
    for leg in range(3):
        outward = (near[leg] - far[leg]) / np.linalg.norm(near[leg] - far[leg])
        frame = places[f"leg{leg + 1}/{weight.bar}"].matrix
        drawn = frame @ [place_along(design.geometry, weight), 0.0, 0.0, 1.0]
        assert drawn[:3] == pytest.approx(near[leg] + beyond * outward, abs=1e-9)


@given(st.floats(0.02, 50))
def test_disc_volumes_are_proportional_to_mass(mass: float) -> None:
    assert STEEL * np.pi * disc_radius(mass) ** 2 * at.BARREL == pytest.approx(mass)


@pytest.mark.parametrize("end", ENDS)
def test_counterweight_stays_in_its_bars_layer_with_few_faces(end: tuple[str, int]) -> None:
    part = counterweight(APPENDIX_4.geometry, Counterweight(*end, 0.2, 5.0))
    low, high = part.bounds()[:, 1]
    room = at.span(end[0])
    assert room[0] - 0.002 < low < high < room[1] + 0.002
    assert sum(len(solid.mesh.faces) for solid in part.solids) < 350


@pytest.mark.slow
def test_file_contains_counterweights_with_mass() -> None:
    weights = (Counterweight("b8", 8, 0.2, 2.0), Counterweight("b3", 7, 0.1, 0.0))
    design = replace(APPENDIX_4, counterweights=weights)
    configuration = inverse_kinematics(design.geometry, (0.05, -0.03, 0.4, -0.6))
    scene = trimesh.load_scene(io.BytesIO(assemble_glb(design, configuration)), file_type="glb")
    names = {name.partition(".")[0] for name in scene.graph.nodes if "weight" in name}
    assert names == {f"leg{leg}_b8_weight1" for leg in (1, 2, 3)}


def test_the_clearance_is_that_of_a_disc_of_the_mass() -> None:
    def text(*place: Any, knee: KneeBranch = KneeBranch.LOWER) -> str:
        return room_text(with_knee(APPENDIX_4.geometry, knee), Counterweight(*place))

    light, heavy = (text("b3", 7, 0.2, mass) for mass in (1.0, 5.0))
    assert light.startswith("A steel disc of 40 mm radius")
    assert heavy.startswith("A steel disc of 89 mm radius")
    assert "while the platform is below z = \N{MINUS SIGN}" in light
    upper = text("b8", 8, 0.05, 0.1, knee=KneeBranch.UPPER)
    assert "above z = " in upper or "It can meet neither" in upper
    assert text("b4", 5, 0.1, 1.0).endswith("at any height.")
