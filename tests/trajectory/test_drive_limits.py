"""The shortest duration within the envelopes and speeds of a design's drives."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from paminsa_viz.actuation.drive_table import drive_table
from paminsa_viz.actuation.duty import Duty, duty_cycle
from paminsa_viz.actuation.sizing import size_drives
from paminsa_viz.model import APPENDIX_4, Design, Drive
from paminsa_viz.trajectory import PRESET, InfeasibleMotion, MotionLimits, minimum_time

SERVO = Drive(
    "servo", 4e-6, 1e-6, 80.0, 0.8, viscous=2e-6, coulomb=2e-3, peak_torque=0.2, top_speed=400.0,
    envelope=((0.0, 0.2), (150.0, 0.2), (500.0, 0.01)),
)  # fmt: skip
AXIS = replace(SERVO, gear_ratio=1.0, transmission="screw", lead=0.01, peak_torque=0.9)
AXIS = replace(AXIS, envelope=((0.0, 0.9), (300.0, 0.9), (600.0, 0.5)), top_speed=600.0)
BENT = replace(SERVO, envelope=((0.0, 0.3), (100.0, 0.15), (350.0, 0.13), (400.0, 0.02)))


def driven(*drives: Drive) -> Design:
    one = drives[0]
    return replace(APPENDIX_4, drives=(one, one, one, drives[1] if len(drives) > 1 else AXIS))


def shares(design: Design, motion) -> np.ndarray:  # type: ignore[no-untyped-def]
    """Largest share of the envelope or the top speed of each drive on a motion."""
    loads = duty_cycle(design, [Duty(motion)]).loads
    return np.array(
        [
            size_drives(load, drive_table([drive])).shares[0, 1:3].max()
            for load, drive in zip(loads, design.drives, strict=True)
        ]
    )


@pytest.mark.parametrize("key", ["paper-like", "arch", "circle", "trapezoid"])
@pytest.mark.parametrize("drive", [SERVO, replace(SERVO, efficiency=1.0), BENT], ids=["", "1", "b"])
def test_drives_reach_a_limit_and_keep_all(key: str, drive: Drive) -> None:
    design = driven(drive)
    quickest = minimum_time(PRESET[key].build(design.geometry), MotionLimits(speed=50.0), design)
    assert quickest.quantity.startswith(("torque-speed envelope of M", "motor speed of M"))
    used = shares(design, quickest.plan.sample(4000))
    assert used.max() <= 1 + 1e-6
    if drive is not BENT:  # a line below the envelope is a little less than it
        lossless = drive.efficiency == 1 and AXIS.lead_efficiency == 1
        assert used.max() > (0.99 if lossless else 0.8)
    slower = quickest.plan.lasting(1.3 * quickest.plan.duration).sample(2000)
    assert shares(design, slower).max() < 1


def test_drives_are_left_out_where_there_are_none_or_on_request() -> None:
    plan, limits = PRESET["arch"].build(APPENDIX_4.geometry), MotionLimits(speed=1.0, torque=5.0)
    bare = minimum_time(plan, limits, APPENDIX_4)
    assert minimum_time(plan, limits, driven(Drive(), AXIS), drives=False).plan.duration > 0
    unlimited = replace(APPENDIX_4, drives=(Drive(), None, None, None))
    assert minimum_time(plan, limits, unlimited).plan.duration == bare.plan.duration
    alone = minimum_time(plan, MotionLimits(), driven(SERVO))
    assert "is reached at" in alone.explanation or "rad/s" in alone.explanation


def test_a_drive_too_weak_for_gravity_is_named() -> None:
    weak = replace(AXIS, peak_torque=0.1)
    with pytest.raises(InfeasibleMotion) as caught:
        minimum_time(PRESET["arch"].build(APPENDIX_4.geometry), MotionLimits(), driven(SERVO, weak))
    assert caught.value.actuator == 3
    assert caught.value.limit == pytest.approx(weak.output_limits.peak)
