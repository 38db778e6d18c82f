"""What is said of a built robot, with guides that are kept, tubes and either knee, from scratch."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from paminsa_viz.clearance import clearance
from paminsa_viz.dimensions.layers import SLIDER_HALF
from paminsa_viz.elastostatics import first_frequencies, platform_stiffness
from paminsa_viz.model import APPENDIX_4, BarLaw, KneeBranch, check_reach, inverse_kinematics
from paminsa_viz.model.design import Design
from paminsa_viz.model.leg_points import bar_length
from paminsa_viz.quantities.requirements import Workspace
from paminsa_viz.synthesis import Guide, SynthesisCase, buildability
from paminsa_viz.synthesis.search.extremes import Extent
from paminsa_viz.synthesis.search.trial import Poses, Robots
from tests.synthesis.search_cases import CYLINDER, TURN

CASES = {
    "guides kept, tubes": replace(
        CYLINDER, guide=Guide.KEPT, bars=BarLaw(tubes=True),
        reference=APPENDIX_4.vary({"payload.mass": 1.5}),
    ),
    "tubes that grow": replace(CYLINDER, bars=BarLaw(grow=True, tubes=True), allow_overlap=False),
    "upper knee": replace(
        CYLINDER, reference=APPENDIX_4.with_knee(KneeBranch.UPPER), allow_overlap=False
    ),
}  # fmt: skip


def trial(case: SynthesisCase, seed: int) -> tuple[Design, Workspace]:
    """A robot near the answer of the worked case that reaches its workspace."""
    rng = np.random.default_rng(seed)
    near = np.array([0.4, 0.085, 4.2, 0.79, 0.45, -0.85])
    numbers = near * rng.uniform(0.96, 1.04, (40, 6))
    if case.reference.geometry.knee is KneeBranch.UPPER:
        numbers[:, 5] = -numbers[:, 5] - 2.0 * case.reference.geometry.platform_joint_height
    robots = Robots.of(case, numbers)
    which = np.flatnonzero((robots.margins > 0.0).all(axis=1))[:1].tolist()
    (found,) = robots.trials(Poses(case), which)
    return found.design, found.workspace


@pytest.mark.slow
@pytest.mark.parametrize("name", CASES)
def test_what_is_said_of_a_built_robot_holds_from_scratch(name: str) -> None:
    case = CASES[name]
    design, space = trial(case, len(name))
    found = buildability(design, space, (-TURN, TURN))
    pose = Extent(space, (-TURN, TURN)).random(400, seed=7)
    assert check_reach(design.geometry, pose).ok.all()
    assert found.within_reach == 1.0
    # extremes are no better than at poses drawn at random, and not far from them
    apart = clearance(design, pose).least
    stiff = platform_stiffness(design, pose[:200]).horizontal
    frequency = first_frequencies(design, pose[:60])
    for stated, drawn, near in (
        (found.clearance, apart, apart.min() - 0.03),
        (found.stiffness, stiff, 0.6 * stiff.min()),
        (found.frequency, frequency, 0.6 * frequency.min()),
    ):
        assert near < stated <= drawn.min() + 1e-9
    assert clearance(design, found.worst).least == pytest.approx(found.clearance, abs=1e-8)
    thousandths = 1000.0 * found.overlapping
    assert thousandths == pytest.approx(round(thousandths), abs=1e-9)
    share = np.mean(apart < 0)
    assert abs(found.overlapping - share) <= 4 * np.sqrt(0.25 / 400) + 0.01
    # guides and shafts
    points = inverse_kinematics(design.geometry, pose).points
    slider = np.linalg.norm((points[8] - points[3])[..., :2], axis=-1).max()
    assert 0.98 * slider <= found.needed_guide - SLIDER_HALF <= 1.05 * slider
    assert found.guide == design.geometry.guide_link_length
    assert found.shaft == design.geometry.shaft_length
    if case.guide is Guide.KEPT:
        assert found.guide == case.reference.geometry.guide_link_length
    elif case.clear:
        assert found.guide >= found.needed_guide
        assert found.shaft >= found.needed_shaft
    # masses
    leg = sum(vars(design.links).values()) + sum(vars(design.joints).values())
    assert found.moving_mass == pytest.approx(3 * leg + design.platform.mass)
    if case.bars.tubes:
        for bar in ("b3", "b4", "b7", "b8"):
            e, ratio = case.reference.elastic, 1.0
            length = bar_length(design.geometry, bar)
            if case.bars.grow:
                ratio = length / bar_length(case.reference.geometry, bar)
            area = np.pi / 4 * (getattr(e, f"{bar}_outer") ** 2 - getattr(e, f"{bar}_inner") ** 2)
            mass = e.density * area * ratio**2 * length
            assert getattr(design.links, bar) == pytest.approx(mass)
            assert design.elastic.section(bar).area == pytest.approx(area * ratio**2)
