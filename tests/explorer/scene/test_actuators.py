"""Arrows of torques and of the force of M4."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import viser

from paminsa_viz.explorer.scene.actuators import FACES, TorqueArrows, arc_arrow, force_arrow
from paminsa_viz.explorer.scene.layers import SceneContext
from tests.support.scene import frame_at


@pytest.mark.parametrize("fraction", [-1.0, -0.3, 0.0, 0.4, 1.0])
def test_arcs_turn_the_way_of_the_torque(fraction: float) -> None:
    corners = arc_arrow(fraction)
    assert corners.shape == arc_arrow(0.9).shape
    assert FACES.max() == len(corners) - 1
    angle = np.unwrap(np.arctan2(corners[:, 1], corners[:, 0]).reshape(-1, 12)[:, 0])
    turned = angle[-1] - angle[0]
    assert np.sign(turned) == (1 if fraction >= 0 else -1)
    assert abs(turned) < 2 * np.pi


def test_longer_arrows_for_greater_efforts() -> None:
    lengths = [np.ptp(force_arrow(f)[:, 2]) for f in (0.1, 0.4, 0.9, 1.0, 5.0)]
    assert lengths == sorted(lengths)
    assert lengths[-1] == lengths[-2]
    assert force_arrow(-0.5)[:, 2].min() < -0.1


def test_torques_that_are_not_finite_are_not_drawn(server: viser.ViserServer) -> None:
    view = TorqueArrows(SceneContext(server.scene))
    frame = frame_at(layers=["torques"])
    view.draw(replace(frame, torques=np.array([np.nan, np.inf, 1.0, 0.0])), False)
    nodes = server.scene._handle_from_node_name
    assert [nodes[f"/efforts/m{k}"].visible for k in (1, 2, 3, 4)] == [False, False, True, False]
