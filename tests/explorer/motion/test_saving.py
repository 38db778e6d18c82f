"""A motion as saved text, and text that is none."""

from __future__ import annotations

import json
from dataclasses import replace
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from paminsa_viz.explorer import persistence
from paminsa_viz.explorer.motion.description import Kind, Motion, Timing
from paminsa_viz.explorer.state import initial_state
from paminsa_viz.model import PaminsaError
from paminsa_viz.trajectory import PRESETS, MotionLimits, Profile, from_samples

lengths = st.floats(-1, 1)
poses = st.tuples(lengths, lengths, lengths, lengths)
some = st.none() | st.floats(0.01, 100)
motions = st.builds(
    Motion,
    kind=st.sampled_from([kind for kind in Kind if kind is not Kind.TABLE]),
    preset=st.sampled_from([preset.key for preset in PRESETS]),
    start=st.none() | poses,
    goal=st.none() | poses,
    height=st.floats(0, 1),
    waypoints=st.lists(poses, max_size=5).map(tuple),
    center=st.none() | poses,
    radius=st.floats(0.001, 1),
    profile=st.sampled_from(Profile),
    timing=st.sampled_from(Timing),
    duration=st.floats(0.1, 100),
    limits=st.builds(MotionLimits, speed=some, turn_jerk=some, torque=some, force=some),
    back=st.booleans(),
    rate=st.floats(50, 10_000),
)


@given(motions)
def test_a_motion_comes_back(motion: Motion) -> None:
    document = replace(initial_state().document, motion=motion)
    assert persistence.load(persistence.dump(document)) == document
    assert persistence.open_share_code(persistence.share_code(document)) == document


def test_the_longest_motion_fits_into_a_share_code() -> None:
    pose = (1 / 3, 1 / 7, 1 / 9, 1 / 11)
    way = tuple(tuple(value * (1 + i / 41) for value in pose) for i in range(40))
    motion = Motion(kind=Kind.WAYPOINTS, waypoints=way)  # type: ignore[arg-type]
    document = replace(initial_state().document, motion=motion)
    assert persistence.open_share_code(persistence.share_code(document)) == document


def test_a_file_is_not_saved() -> None:
    table = from_samples([0.0, 1.0], [[0.0] * 4, [0.1] * 4])
    document = replace(initial_state().document, motion=Motion(kind=Kind.TABLE, table=table))
    assert persistence.load(persistence.dump(document)) == initial_state().document


@pytest.mark.parametrize(
    "bad",
    [
        {"kind": "fly"},
        {"kind": "table"},
        {"preset": "none of them"},
        {"duration": -1},
        {"duration": "1"},
        {"duration": True},
        {"start": [0, 0, 0]},
        {"start": [1e9, 0, 0, 0]},
        {"waypoints": [[0, 0, 0, 0]] * 41},
        {"waypoints": 3},
        {"limits": {"speed": -1}},
        {"limits": {"color": 1}},
        {"limits": 4},
        7,
    ],
)
def test_what_is_no_motion_is_refused(bad: Any) -> None:
    text = json.loads(persistence.dump(initial_state().document)) | {"motion": bad}
    with pytest.raises(PaminsaError):
        persistence.load(json.dumps(text))


OLD_CODE = (
    "PMZ1-eNpdUe9qwyAQf5Xg5y7YpGFj3_YcpQyrl-Bq1J6mWxf67vMu6QoFEe73z7tzFl6NIN4r8REjeGN_qp3YVMJAsoMv"
    "-Hwr1QUw2UDltlQqJRiP7kquiNZnMGSJIVHQXtZyUz2uF1l3XXMoAoQeELwmlZ-cK9AY8pI7i5P1hhK1Re2AAlNWmJfE8q"
    "zkQ2mU9a2uMZSnE_F7-UQ_HHWzdnAglwaf8d7kwsiWVNtFtbSpjJ0ot5BvNBeG3jreUUYV4TdYnjfb0fqB4MFewPPWJlTr"
    "QE3dFcAVDfc4ixQBDKe-knlC_3mHGtqTUFqDg_-AjkHWPTHr7r4AT4-KhSvUysUb8DxR3zsu-4C8-lYWmn71qDSpM07AY2"
    "diO2Zvf-UJlx8"
)
"""A circle as a share code of version 0.1.0, when its center was saved as ``centre``."""


def test_share_codes_of_earlier_versions_still_open() -> None:
    assert persistence.open_share_code(OLD_CODE).motion == Motion(
        kind=Kind.CIRCLE,
        center=(0.02, -0.03, 0.1, -0.52),
        radius=0.08,
        start=(0.1, 0.0, 0.0, -0.5),
        waypoints=((0.0, 0.0, 0.0, -0.5), (0.1, 0.0, 0.2, -0.55)),
        profile=Profile.TRAPEZOID,
        timing=Timing.GIVEN,
        duration=2.5,
        limits=MotionLimits(
            speed=0.7, turn_speed=2.0, acceleration=5.0, turn_jerk=30.0, torque=4.0, force=300.0
        ),
        back=True,
        rate=500.0,
    )
