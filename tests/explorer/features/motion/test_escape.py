"""The escape twist in the scene."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from paminsa_viz.explorer.core import motion as motions
from paminsa_viz.explorer.features.motion.escape import LONGEST
from paminsa_viz.explorer.state.motion import Kind, Timing
from paminsa_viz.explorer.state.state import State, initial_state
from paminsa_viz.model import inverse_jacobian
from tests.support.scene import Scene


@pytest.fixture
def crossing() -> State:
    state = motions.choose_kind(initial_state(), Kind.MOVE)
    state = motions.limit(state, "torque", 10.0)
    ends = {"start": (0.03, 0.02, 0.8, -0.5), "goal": (0.03, 0.02, 1.75, -0.5)}
    return motions.change(state, timing=Timing.SHORTEST, cross=True, **ends)


@pytest.mark.slow
def test_arrows_are_a_motion_that_no_actuator_feels(scene: Scene, crossing: State) -> None:
    scene.show(crossing)
    arrows = np.asarray(scene.nodes["/escape/arrows"].points, dtype=float)
    moves = arrows[:, 1] - arrows[:, 0]
    assert np.linalg.norm(moves, axis=1).max() == pytest.approx(LONGEST, rel=1e-6)
    found = motions.planned(crossing).crossing
    assert found is not None
    pose = np.array(found.crossings[0].crossing.pose)
    np.testing.assert_allclose(arrows[0, 0], pose[[0, 1, 3]], atol=1e-6)
    (ax, ay), (mx, my) = (arrows[1, 0] - arrows[0, 0])[:2], (moves[1] - moves[0])[:2]
    turn = (ax * my - ay * mx) / (ax**2 + ay**2)
    twist = np.array([moves[0, 0], moves[0, 1], turn, moves[0, 2]])
    felt = inverse_jacobian(crossing.document.design.geometry, pose) @ twist
    assert np.abs(felt).max() < 1e-5 * np.abs(twist).max()


@pytest.mark.slow
def test_arrows_leave_with_the_layer_and_with_the_motion(scene: Scene, crossing: State) -> None:
    hidden = replace(crossing, layers=crossing.layers - {"escape_twist"})
    for state, shown in (
        (crossing, True),
        (hidden, False),
        (crossing, True),
        (motions.change(crossing, cross=False), False),
    ):
        scene.show(state)
        assert ("/escape/arrows" in scene.nodes) is shown
        assert ("/escape/label0" in scene.nodes) is shown
