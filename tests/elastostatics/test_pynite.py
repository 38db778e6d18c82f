"""The whole robot in PyNite, by members and end releases instead of our elements and joints."""

from __future__ import annotations

import numpy as np
import pytest

from paminsa_viz.elastostatics.leg_matrices import leg_matrices
from paminsa_viz.elastostatics.modes import natural_modes
from paminsa_viz.elastostatics.stiffness import platform_stiffness
from paminsa_viz.elastostatics.vibration import whole_matrices
from paminsa_viz.model.design import APPENDIX_4, Design, KneeBranch
from tests.elastostatics.robots import POSE, elastic_design, poses_of
from tests.support.samples import resized

pytest.importorskip("Pynite", reason="PyNiteFEA comes with the extra 'test'")
from tests.elastostatics.pynite_model import compliance, frequencies

ROBOTS = [(0, KneeBranch.LOWER), (1, KneeBranch.UPPER), (4, KneeBranch.LOWER)]
"""Seeds of robots, and their knees."""


def difference(design, pose, **options: float) -> float:
    """Of the largest compliance; rotations count as displacements at R_b / 3."""
    lengths = np.repeat([1.0, design.geometry.base_radius / 3], 3)
    ours = platform_stiffness(design, pose).compliance * lengths * lengths[:, None]
    theirs = compliance(design, pose, **options) * lengths * lengths[:, None]
    return float(np.abs(ours - theirs).max() / np.abs(ours).max())


@pytest.mark.parametrize(("seed", "knee"), ROBOTS)
def test_compliance_of_the_whole_robot(seed: int, knee: KneeBranch) -> None:
    design = elastic_design(seed, soft_joints=False).with_knee(knee)
    pose = poses_of(design, 1, seed)[0]
    for times in (1, 100):  # tubes stay as they are
        there = pose * [times, times, 1, times]
        assert difference(resized(design, times), there) < 1e-5, times


@pytest.mark.slow
def test_shaft_that_is_welded_to_the_guide_link_is_another_robot() -> None:
    """What PyNite makes of the root of B10 where it is: half as stiff again in every direction."""
    assert difference(APPENDIX_4, np.array(POSE)) < 1e-5
    assert difference(APPENDIX_4, np.array(POSE), aside=0.0) > 0.05


def with_slender_bars(design: Design) -> Design:
    """The same robot with bars that are lines of mass."""
    g = design.geometry
    lengths = {
        "b3": g.crank_length, "b4": g.coupler_length, "b7": g.short_coupler_length,
        "b8": g.crank_length,
    }  # fmt: skip
    changes = {f"inertias.{bar}_axial": 0.0 for bar in lengths} | {"inertias.b2_vertical": 0.0}
    for bar, length in lengths.items():
        changes[f"inertias.{bar}_transverse"] = getattr(design.links, bar) * length**2 / 12
    changes["inertias.b10_vertical"] = design.links.b10 * g.guide_link_length**2 / 12
    return design.vary(changes)


@pytest.mark.slow
@pytest.mark.parametrize(("seed", "knee"), ROBOTS)
def test_natural_frequencies_of_the_whole_robot(seed: int, knee: KneeBranch) -> None:
    """All six in which the platform moves, and payload and pins besides."""
    design = with_slender_bars(elastic_design(seed, soft_joints=False).with_knee(knee))
    pose = poses_of(design, 1, seed)[0]
    stiffness, mass = whole_matrices(leg_matrices(design, 2), pose, loaded=False)
    ours = natural_modes(stiffness, mass, 6).frequencies
    assert frequencies(design, pose) == pytest.approx(ours, rel=1e-4)
