"""Bodies with folded masses: possible ones, with the energies of the design."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from paminsa_viz.engines.mechanism import build_mechanism
from paminsa_viz.engines.poses import start_values, world_frames
from paminsa_viz.engines.rigid_bodies import rigid_bodies
from paminsa_viz.errors import InvalidInput
from paminsa_viz.model import mass_matrix
from paminsa_viz.model.design import APPENDIX_4, Counterweight, Design
from tests import oracle
from tests.support import samples

EACH = samples.each_robot((20, 21))


def poses_of(design: Design, pose: Any) -> dict[str, tuple[Any, Any]]:
    return world_frames(build_mechanism(design), start_values(design, pose))


@EACH
def test_kinetic_energy_is_that_of_the_mass_matrix(design: Design) -> None:
    design = replace(design, counterweights=(Counterweight("b8", 8, 0.4, 0.1),))
    bodies = rigid_bodies(build_mechanism(design))
    pose, rate, _ = (a[0] for a in samples.random_states(np.random.default_rng(3), design))
    step = 1e-5
    before, after = (poses_of(design, pose + sign * step * rate) for sign in (-1, 1))
    energy = 0.0
    for name, body in bodies.items():
        (p0, r0), (p1, r1) = before[name], after[name]
        speed = (p1 + r1.apply(body.center) - p0 - r0.apply(body.center)) / (2 * step)
        turning = (r0.inv() * r1).as_rotvec() / (2 * step)
        energy += 0.5 * body.mass * speed @ speed + 0.5 * np.sum(body.inertia * turning**2)
    assert energy == pytest.approx(0.5 * rate @ mass_matrix(design, pose) @ rate, rel=1e-7)


@EACH
def test_masses_and_their_moments_are_those_of_first_principles(design: Design) -> None:
    pose = samples.random_poses(np.random.default_rng(4), design, 1)[0]
    frames, bodies = poses_of(design, pose), rigid_bodies(build_mechanism(design))
    moment = sum(
        body.mass * (frames[name][0] + frames[name][1].apply(body.center))[2]
        for name, body in bodies.items()
    )
    every = oracle.bodies(design, oracle.split(pose))
    assert sum(b.mass for b in bodies.values()) == pytest.approx(sum(b.mass for b in every))
    wanted = sum(body.mass * float(body.center[2]) for body in every)
    assert moment == pytest.approx(wanted, rel=1e-12)


@EACH
def test_each_is_a_body_that_there_can_be(design: Design) -> None:
    for body in rigid_bodies(build_mechanism(design)).values():
        assert body.mass > 0
        inertia = np.array(body.inertia)
        assert (inertia > 0).all()
        assert (inertia.sum() - 2 * inertia > -1e-12).all(), body.name


@pytest.mark.parametrize(
    ("change", "text"),
    [
        ({"joints.j8": 0.0}, "leg1_slider with its joints has 0 kg"),
        ({"platform.inertia": 0.0, "payload.inertia": 0.0}, "platform with its joints has 0 kg m"),
        ({"links.b1": 0.0}, "lift with its joints has 0 kg"),
    ],
)
def test_a_body_without_mass_or_inertia_is_refused(change: dict[str, float], text: str) -> None:
    with pytest.raises(InvalidInput, match=text):
        rigid_bodies(build_mechanism(APPENDIX_4.vary(change)))
