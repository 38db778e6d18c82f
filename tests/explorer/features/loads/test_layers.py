"""Forces at joints as arrows, and bars by load."""

from __future__ import annotations

import numpy as np

from paminsa_viz.elastostatics.bar_loads import utilization
from paminsa_viz.elastostatics.joint_forces import JOINT_INDEX, joint_forces
from paminsa_viz.explorer.features.loads.layers import (
    LONGEST,
    bar_lines,
    force_arrows,
    sleeve_places,
)
from paminsa_viz.explorer.scene.forces import BAR, scale_text
from paminsa_viz.model import APPENDIX_4
from tests.support.scene import POSE, Scene, solved


def test_arrows_start_at_the_joints_and_are_to_the_stated_scale(scene: Scene) -> None:
    forces, configuration = joint_forces(APPENDIX_4, POSE), solved()
    arrows, scale = force_arrows(forces, configuration)
    arrows = arrows.reshape(3, 10, 2, 3)
    vectors = (arrows[:, :, 1] - arrows[:, :, 0]) * scale / BAR
    np.testing.assert_allclose(np.linalg.norm(vectors, axis=-1), forces.magnitude, rtol=1e-12)
    assert np.linalg.norm(arrows[:, :, 1] - arrows[:, :, 0], axis=-1).max() <= LONGEST * 1.000001
    np.testing.assert_allclose(arrows[:, JOINT_INDEX["9"], 0], configuration.points[9])
    np.testing.assert_allclose(vectors[..., 2], forces.force[..., 2], rtol=1e-9)
    # the three forces on the platform, in space, and its weight are in balance
    weight = APPENDIX_4.platform.mass * APPENDIX_4.gravity
    np.testing.assert_allclose(vectors[:, JOINT_INDEX["5"]].sum(axis=0), [0, 0, weight], atol=1e-9)
    scene.draw(layers=["joint_forces"])
    assert scale_text(scale, 1.0) in scene.nodes["/joint_forces/label_joint_forces"].text


def test_sleeves_cover_the_bars_and_the_lightest_has_most_stress(scene: Scene) -> None:
    scene.draw(layers=["utilization"])
    node = scene.nodes["/joint_forces/bars"]
    lines = bar_lines(solved())
    length = np.linalg.norm(lines[:, 1] - lines[:, 0], axis=1)
    np.testing.assert_allclose(np.asarray(node.batched_scales)[:, 2], length, rtol=1e-6)
    use = utilization(joint_forces(APPENDIX_4, POSE))
    text = scene.nodes["/joint_forces/label_utilization"].text
    assert f"{100 * use.max():.2g} %" in text
    middles, turns, _ = sleeve_places(lines)
    w, x, y, z = turns.T
    axis = np.stack([2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)], axis=1)
    np.testing.assert_allclose(axis * length[:, None], lines[:, 1] - lines[:, 0], atol=1e-6)
    np.testing.assert_allclose(middles, lines.mean(axis=1), atol=1e-6)


def test_nothing_is_made_while_hidden(scene: Scene) -> None:
    scene.draw(layers=[])
    assert not shown_nodes(scene)
    scene.draw(layers=["joint_forces", "utilization"])
    assert len(shown_nodes(scene)) == 4
    scene.draw(layers=[])
    assert not shown_nodes(scene)


def shown_nodes(scene: Scene) -> list[str]:
    return [name for name in scene.shown if name.startswith("/joint_forces/")]
