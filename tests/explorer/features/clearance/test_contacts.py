"""The layer of contacts: a ball and a label wherever bars of a leg would touch."""

from __future__ import annotations

import numpy as np
import pytest

from paminsa_viz.elastostatics.leg_frame import PAIRS, contacts, pair_name
from paminsa_viz.model import APPENDIX_4
from tests.support.scene import POSE, UPPER, Scene


@pytest.mark.slow
def test_balls_are_where_bars_would_touch(scene: Scene) -> None:
    scene.draw(layers=["contacts"])
    found = contacts(APPENDIX_4, POSE)
    expected = {f"/contacts/{leg + 1}-{pair}" for leg, pair in np.argwhere(found.gap < 0)}
    balls = {name for name in scene.nodes if name.startswith("/contacts/") and "-" in name}
    assert balls == expected
    shaft_and_guide = PAIRS.index(("b2", "b10"))
    name = f"/contacts/2-{shaft_and_guide}"
    place = found.point[1, shaft_and_guide]
    np.testing.assert_allclose(scene.nodes[name].position, place)
    texts = [pair_name(int(pair)) for pair in np.flatnonzero(found.gap[1] < 0)]
    assert scene.nodes["/contacts/2"].text == ", ".join(texts)
    assert pair_name(shaft_and_guide) == "B2–B10"
    top = max((found.point[1, found.gap[1] < 0]), key=lambda point: point[2])
    label = scene.nodes["/contacts/2"].position
    np.testing.assert_allclose(label[:2], top[:2])
    assert 0.0 < label[2] - top[2] < 0.05
    whole, above = np.ptp(scene.nodes[name].vertices), label[2] - top[2]
    scene.draw(design=APPENDIX_4.vary({"geometry.body_scale": 0.5}), layers=["contacts"])
    assert np.ptp(scene.nodes[name].vertices) == pytest.approx(whole / 2)
    assert scene.nodes["/contacts/2"].position[2] - top[2] == pytest.approx(above / 2)


@pytest.mark.slow
def test_layer_follows_the_pose_and_hides(scene: Scene) -> None:
    shaft_and_guide = PAIRS.index(("b2", "b10"))
    scene.draw(layers=["contacts"])
    assert f"/contacts/1-{shaft_and_guide}" in scene.nodes
    scene.draw((0.0, 0.0, 0.0, 0.6), UPPER, layers=["contacts"])
    assert f"/contacts/1-{shaft_and_guide}" not in scene.nodes
    scene.draw(layers=[])
    assert not any(name.startswith("/contacts/") for name in scene.nodes)
