"""Bodies with folded masses: possible ones, with the energies of the design."""

from __future__ import annotations

import re
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from paminsa_viz.engines.mechanism import Part, build_mechanism
from paminsa_viz.engines.poses import start_values, world_frames
from paminsa_viz.engines.rigid_bodies import SLEEVE, _check, rigid_bodies
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


@EACH
def test_what_only_turns_about_the_vertical_has_the_inertia_of_its_rods_and_parts(
    design: Design,
) -> None:
    """Three arms as rods; guide and slider, which turn together, share that of the guide."""
    tree = build_mechanism(design)
    bodies = rigid_bodies(tree)
    lift = next(link for link in tree.links if link.name == "lift")
    share = (np.arange(1000) + 0.5) / 1000
    squares = [
        ((np.outer(1 - share, rod.start) + np.outer(share, rod.end))[:, :2] ** 2).sum(axis=1).mean()
        for rod in lift.rods
    ]
    arms = bodies["lift"]
    assert arms.inertia[2] == pytest.approx(arms.mass * np.mean(squares), rel=1e-5)
    radius = design.platform.inertia + design.payload.inertia
    assert bodies["platform"].inertia[2] == pytest.approx(radius)
    for leg in (1, 2, 3):
        guide, slider = bodies[f"leg{leg}_B10"], bodies[f"leg{leg}_slider"]
        own = design.inertias.b10_vertical
        assert guide.inertia[2] + slider.inertia[2] == pytest.approx(own)
        expected = min(slider.mass * SLEEVE**2, own / 2)
        assert slider.inertia[2] == pytest.approx(expected)
        assert bodies[f"leg{leg}_B2"].inertia[2] == pytest.approx(design.inertias.b2_vertical)


def test_a_heavy_slider_takes_no_more_than_half_of_the_guides_inertia() -> None:
    heavy = APPENDIX_4.vary({"joints.j8": 50.0})
    body = rigid_bodies(build_mechanism(heavy))["leg1_slider"]
    assert body.inertia[2] == pytest.approx(heavy.inertias.b10_vertical / 2)


def test_the_least_body_that_is_taken_has_a_milligram_and_a_square_millimeter_of_a_gram() -> None:
    for mass, inertia, refused in (
        (1e-6, 1e-9, ""), (0.99e-6, 1e-9, "kg;"), (1e-6, 0.99e-9, "kg·m²;"),
    ):  # fmt: skip
        body = Part("b", mass, (0.0, 0.0, 0.0), (1.0, inertia, 1.0))
        if not refused:
            _check(body)
            continue
        with pytest.raises(InvalidInput, match=re.escape(refused)):
            _check(body)


@pytest.mark.parametrize(
    ("change", "text"),
    [
        ({"joints.j8": 0.0}, "leg1_slider with its joints has 0 kg"),
        ({"platform.inertia": 0.0, "payload.inertia": 0.0}, "platform with its joints has 0 kg·m²"),
        ({"links.b1": 0.0}, "lift with its joints has 0 kg"),
    ],
)
def test_a_body_without_mass_or_inertia_is_refused(change: dict[str, float], text: str) -> None:
    with pytest.raises(InvalidInput, match=text):
        rigid_bodies(build_mechanism(APPENDIX_4.vary(change)))
