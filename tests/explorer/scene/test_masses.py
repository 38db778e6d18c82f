"""Masses in a scene: payload, counterweights, centers of mass and their weight."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from paminsa_viz.explorer.scene.bodies import node_name
from paminsa_viz.explorer.scene.mechanism import gravity_arrows, mass_centers
from paminsa_viz.explorer.scene.sizes import LEAST
from paminsa_viz.model.design import APPENDIX_4
from paminsa_viz.model.leg_points import counterweight_point
from paminsa_viz.model.lumped import lumped_coefficients
from paminsa_viz.model.parameters import Counterweight
from tests.support.samples import prototype_times, random_poses
from tests.support.scene import Scene, solved


def test_payload_grows_with_its_mass(scene: Scene) -> None:
    name = "/robot/platform/payload"
    scene.draw()
    assert name not in scene.nodes
    scene.draw(design=APPENDIX_4.vary({"payload.mass": 1.0}))
    one = scene.nodes[name].scale
    scene.draw(design=APPENDIX_4.vary({"payload.mass": 8.0}))
    assert scene.nodes[name].scale == pytest.approx(2 * one)
    assert scene.nodes[name].visible
    scene.draw()
    assert not scene.nodes[name].visible


@pytest.mark.slow
def test_counterweights_are_nodes_of_their_bars(scene: Scene) -> None:
    layers = ["mesh"]
    scene.draw(layers=layers)
    bare = set(scene.nodes)
    weights = (Counterweight("b8", 8, 0.2, 2.0), Counterweight("b3", 7, 0.1, 1.0))
    design = replace(APPENDIX_4, counterweights=weights)
    scene.draw(design=design, layers=layers)
    added = set(scene.nodes) - bare
    assert added == {
        f"{node_name(f'leg{leg}/{bar}')}/weight{number}"
        for leg in (1, 2, 3)
        for number, bar in ((1, "b8"), (2, "b3"))
    }
    with scene.sent() as messages:
        scene.draw((0.0, 0.02, 0.1, -0.55), design, layers)
    assert not {m.name for m in messages} & added
    heavier = replace(design, counterweights=(replace(weights[0], mass=3.0), weights[1]))
    with scene.sent() as messages:
        scene.draw((0.0, 0.02, 0.1, -0.55), heavier, layers)
    assert {m.name for m in messages} == {name for name in added if name.endswith("1")}
    scene.draw(design=replace(design, counterweights=weights[1:]), layers=layers)
    assert set(scene.nodes) - bare == {f"{node_name(f'leg{leg}/b3')}/weight1" for leg in (1, 2, 3)}
    scene.draw(layers=layers)
    assert set(scene.nodes) == bare


def test_mass_centers_have_the_designs_mass_and_potential_energy() -> None:
    design = APPENDIX_4.vary({"payload.mass": 3.0})
    configuration = solved(design=design)
    points = mass_centers(design, configuration)
    joints = sum(getattr(design.joints, f"j{i}") for i in (2, 3, 4, 5, 7, 8, 9))
    links = sum(getattr(design.links, f"b{i}") for i in (1, 2, 3, 4, 7, 8, 10))
    total = 3 * (joints + links) + design.platform.mass + 3.0
    assert points.mass.sum() == pytest.approx(total)
    # Together they have the potential energy of Eq. 11.
    c = lumped_coefficients(design)
    other = solved((0.0, 0.0, 0.2, -0.5), design)
    change = points.mass @ (mass_centers(design, other).center - points.center)[:, 2]
    legs = sum(
        c[i] * (b - a).sum()
        for i, a, b in (
            (0, configuration.points[5][:, 2], other.points[5][:, 2]),
            (1, configuration.points[9][:, 2], other.points[9][:, 2]),
            (2, configuration.points[2][:, 2], other.points[2][:, 2]),
        )
    )
    platform = (design.platform.mass + 3.0) * 0.1
    assert change == pytest.approx(legs / design.gravity + platform, abs=1e-9)


def test_mass_centers_include_counterweights(scene: Scene) -> None:
    weight = Counterweight("b8", 8, 0.2, 2.0)
    design = replace(APPENDIX_4, counterweights=(weight,))
    at = counterweight_point(design.geometry, weight)
    for pose in random_poses(np.random.default_rng(5), n=3):
        configuration = solved(pose)
        bare, loaded = mass_centers(APPENDIX_4, configuration), mass_centers(design, configuration)
        assert loaded.mass[-3:] == pytest.approx(2.0)
        assert len(loaded.mass) == len(bare.mass) + 3 == len(loaded.color)
        z5, z9 = (configuration.points[joint][:, 2] for joint in (5, 9))
        assert loaded.center[-3:, 2] == pytest.approx(at.z5 * z5 + at.r9 * z9 + at.z0)
    scene.draw(pose, layers=["mass_centers"])
    scene.draw(pose, design, ["mass_centers"])  # more spheres than before: the node is made again
    assert len(scene.nodes["/masses/centers"].batched_positions) == len(loaded.mass)


def test_weights_of_grams_are_seen_to_differ() -> None:
    """All arrows of a robot of a tenth of the size had the shortest length."""
    points = mass_centers(prototype_times(0.1), solved())
    lengths = np.ptp(gravity_arrows(points, 9.81, LEAST)[..., 2], axis=1)
    heaviest = points.mass > 0.1 * points.mass.max()
    ratio = lengths[heaviest] / points.mass[heaviest]
    np.testing.assert_allclose(ratio, ratio[0])


def test_gravity_arrows_are_proportional_to_the_weight() -> None:
    points = mass_centers(APPENDIX_4, solved())
    arrows = gravity_arrows(points, 9.81)
    drop = arrows[:, 0] - arrows[:, 1]
    assert drop[:, :2] == pytest.approx(np.zeros((len(drop), 2)))
    heavy = points.mass > 0.25
    ratio = drop[heavy, 2] / points.mass[heavy]
    assert ratio == pytest.approx(np.full(heavy.sum(), ratio[0]))
    assert drop[points.mass == 0, 2] == pytest.approx(0.0)
    assert gravity_arrows(points, 0.0)[:, 0] == pytest.approx(gravity_arrows(points, 0.0)[:, 1])
