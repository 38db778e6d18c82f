"""Presets: possible, sized for the robot, and what the paper-like one claims."""

from __future__ import annotations

import numpy as np
import pytest

from paminsa_viz.model import APPENDIX_4, KneeBranch
from paminsa_viz.trajectory import PRESET, check_path, home, paper_like
from tests.samples import with_knee
from tests.trajectory.plans import ALL_PRESETS, place, preset_plan

LENGTHS = (
    "base_radius", "platform_radius", "arm_length", "shaft_length", "crank_length",
    "coupler_length", "platform_joint_height", "guide_link_length",
)  # fmt: skip


@ALL_PRESETS
@pytest.mark.parametrize("knee", KneeBranch)
@pytest.mark.parametrize("scale", [1.0, 2.5])
def test_the_robot_can_run_it_and_so_can_one_of_another_size(preset, knee, scale) -> None:
    geometry = APPENDIX_4.vary(
        {f"geometry.{name}": scale * APPENDIX_4.value(f"geometry.{name}") for name in LENGTHS}
    ).geometry
    plan = preset.build(with_knee(geometry, knee))
    check = check_path(geometry, plan.sample())
    assert check.ok
    assert check.closest.margin > 0.05 * scale * APPENDIX_4.geometry.base_radius
    np.testing.assert_allclose(
        plan.curve(np.array([0.0, 1.0]))[:, [0, 1, 3]] / scale,
        preset.build(with_knee(APPENDIX_4.geometry, knee)).curve(np.array([0.0, 1.0]))[
            :, [0, 1, 3]
        ],
        atol=1e-12,
    )


def test_home() -> None:
    np.testing.assert_allclose(home(APPENDIX_4.geometry), [0, 0, 0, -0.5], atol=1e-15)
    height = APPENDIX_4.geometry.platform_joint_height
    mirror = home(with_knee(APPENDIX_4.geometry, KneeBranch.UPPER))
    assert mirror[3] + height == pytest.approx(0.5 - height)


@pytest.mark.parametrize("knee", KneeBranch)
def test_paper_like_accelerates_at_1_meter_per_second_squared(knee: KneeBranch) -> None:
    plan = paper_like(with_knee(APPENDIX_4.geometry, knee))
    peaks = plan.duration * np.array([0.5 - np.sqrt(3) / 6, 0.5 + np.sqrt(3) / 6])
    np.testing.assert_allclose(place(plan.at(peaks).acceleration), 1.0, rtol=1e-14)
    t = np.linspace(0, plan.duration, 20001)
    assert place(plan.at(t).acceleration).max() <= 1 + 1e-14
    moved = np.abs(plan.at(plan.duration).pose - plan.at(0.0).pose)
    assert (moved > 0.05).all()  # all four coordinates


def test_no_preset_claims_to_be_the_papers() -> None:
    assert list(PRESET) == [preset.key for preset in PRESET.values()]
    for preset in PRESET.values():
        plan = preset_plan(preset)
        assert "paper" not in f"{plan.name} {plan.kind} {preset.label}".lower()
    (note,) = preset_plan(PRESET["paper-like"]).notes
    assert "not the motion of the paper" in note
