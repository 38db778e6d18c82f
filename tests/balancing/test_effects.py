"""What a change of the masses does, in numbers."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from paminsa_viz.balancing import whole_mass
from paminsa_viz.balancing.effects import IN_MOTION, UNITS, effects, sizes_in_motion
from paminsa_viz.model import APPENDIX_4, Counterweight, static_imbalance
from paminsa_viz.trajectory import analyze
from tests import oracle
from tests.balancing.robots import solved, trajectory
from tests.balancing.weighted import bodies

HEAVIER = APPENDIX_4.vary({"joints.j7": 2.0})


def test_sizes_in_motion_are_those_of_the_torques_themselves() -> None:
    found = analyze(APPENDIX_4, trajectory(), keep=solved())
    peak, rms, power = sizes_in_motion(found)
    torque = np.asarray(found.torque)
    np.testing.assert_allclose(peak, np.abs(torque).max(axis=0))
    np.testing.assert_allclose(rms, [abs(each.rms) for each in found.summary])
    np.testing.assert_allclose(power, [abs(each.top_power) for each in found.summary])
    far = replace(trajectory(), pose=trajectory().pose - np.array([0.0, 0.0, 0.0, 9.0]))
    none = sizes_in_motion(analyze(APPENDIX_4, far))
    assert none.shape == (3, 4)
    assert np.isnan(none).all()


def test_effects_have_a_row_for_every_motor_in_its_unit() -> None:
    sizes = {IN_MOTION[0]: (np.arange(4.0), np.arange(4.0, 8.0))}
    found = effects(APPENDIX_4, HEAVIER, sizes)
    assert [item.label for item in found][:2] == ["M_p2", "mass with payload"]
    assert found[0].before == static_imbalance(APPENDIX_4)
    assert found[0].after == static_imbalance(HEAVIER)
    added = 3 * (2.0 - APPENDIX_4.joints.j7)
    assert found[1].after - found[1].before == pytest.approx(added)
    assert [(item.before, item.after, item.unit) for item in found[2:]] == [
        (float(i), 4.0 + i, UNITS[IN_MOTION[0]][i]) for i in range(4)
    ]


def test_the_whole_mass_is_that_of_all_bodies_that_move() -> None:
    weights = (Counterweight("b3", 7, 0.1, 0.7),)
    payload = replace(APPENDIX_4.payload, mass=2.5)
    pose = oracle.split(np.array([0.0, 0.0, 0.0, -0.5]))
    for design in (APPENDIX_4, replace(HEAVIER, counterweights=weights, payload=payload)):
        found = sum(body.mass for body in bodies(design, pose))
        assert whole_mass(design) == pytest.approx(found)
