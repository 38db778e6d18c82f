"""Views of the robot."""

from __future__ import annotations

import numpy as np
import pytest

from paminsa_viz.explorer.scene.cameras import CAMERAS, preset
from paminsa_viz.model.design import APPENDIX_4, KneeBranch
from tests.support.samples import with_knee
from tests.support.scene import solved


@pytest.mark.parametrize("knee", list(KneeBranch))
@pytest.mark.parametrize("name", CAMERAS)
@pytest.mark.parametrize("aspect", [0.6, 1.0, 1.6])
def test_presets_hold_the_robot_in_the_picture(name: str, knee: KneeBranch, aspect: float) -> None:
    sign = -knee.sign
    configuration = solved((0.0, 0.0, 0.1, sign * 0.45), with_knee(APPENDIX_4, knee))
    view = preset(name, with_knee(APPENDIX_4.geometry, knee), configuration, aspect)
    position, look = np.array(view.position), np.array(view.look_at)
    back = (position - look) / np.linalg.norm(position - look)
    right = np.cross([0.0, 0.0, 1.0], back)
    right /= np.linalg.norm(right)
    up = np.cross(back, right)
    legs = [int(name[-1]) - 1] if name.startswith("Leg") else [0, 1, 2]
    points = (
        np.concatenate([configuration.points[j][legs] for j in (2, 3, 4, 5, 7, 8, 9)]) - position
    )
    depth = -points @ back
    limit = np.tan(view.fov / 2)
    assert (depth > 0.05).all()
    assert (np.abs(points @ up) < limit * depth).all()
    assert (np.abs(points @ right) < aspect * limit * depth).all()


def test_a_leg_is_seen_square_on() -> None:
    configuration = solved()
    for leg in range(3):
        view = preset(f"Leg {leg + 1}", APPENDIX_4.geometry, configuration=configuration)
        sight = np.subtract(view.look_at, view.position)
        heading = [np.cos(configuration.beta[leg]), np.sin(configuration.beta[leg]), 0.0]
        assert sight @ heading == pytest.approx(0.0, abs=1e-9)


def test_unknown_preset() -> None:
    with pytest.raises(KeyError):
        preset("Leg 4", APPENDIX_4.geometry)
