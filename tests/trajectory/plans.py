"""Motions that the trajectory tests share."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from paminsa_viz.model import APPENDIX_4, KneeBranch
from paminsa_viz.trajectory import (
    PRESETS,
    Plan,
    Profile,
    TimeLaw,
    arch,
    chain,
    circle,
    line,
    point_to_point,
    round_trip,
    via_points,
)
from paminsa_viz.trajectory.supremum import GAP
from tests.support.samples import with_knee

A = np.array([-0.08, 0.03, -0.3, -0.55])
B = np.array([0.07, -0.05, 0.4, -0.45])
C = np.array([0.02, 0.08, 0.1, -0.5])
LAWS = [
    TimeLaw(),
    TimeLaw(Profile.TRAPEZOID, ramp=0.2),
    TimeLaw(Profile.S_CURVE, ramp=0.35, blend=0.3),
]

FRICTION = {
    "friction.viscous_rotary": 0.7,
    "friction.viscous_linear": 40.0,
    "friction.coulomb_rotary": 0.2,
    "friction.coulomb_linear": 5.0,
}


def all_plans() -> list[Plan]:
    """Every planner with every law it takes."""
    plans = []
    for law in LAWS:
        plans += [
            point_to_point(A, B, 1.3, law),
            line(A, [0.1, 0.02, -0.5], 0.9, law),
            circle(C, 0.06, 2.0, law, plane="xz", begin=0.7, angle=-5.0),
            arch(A, B, 0.08, 1.1, law, lift_share=0.35, overlap=0.6),
            round_trip(point_to_point(A, B, 0.7, law)),
        ]
    plans += [
        via_points([A, B, C, A], 3.0),
        via_points([A, C, B], times=[1.0, 1.5, 3.0], name="timed waypoints"),
        chain(
            point_to_point(A, B, 0.8), point_to_point(B, C, 0.5, LAWS[2]), via_points([C, A], 1.0)
        ),
    ]
    return plans


PLANS = pytest.mark.parametrize(
    "plan", [pytest.param(p, id=f"{p.name}: {p.kind}") for p in all_plans()]
)
"""Runs a test with every planner."""

ALL_PRESETS = pytest.mark.parametrize("preset", [pytest.param(p, id=p.key) for p in PRESETS])
"""Runs a test with every preset."""


def preset_plan(preset: Any, knee: KneeBranch = KneeBranch.LOWER) -> Plan:
    return preset.build(with_knee(APPENDIX_4.geometry, knee))


def inside(plan: Plan, count: int = 7) -> Any:
    """Instants of unit time inside the pieces between breaks."""
    share = (np.arange(count) + 0.5) / count
    begin, end = plan.curve.breaks[:-1, None], plan.curve.breaks[1:, None]
    return (begin + (end - begin) * share).ravel()


def dense(plan: Plan, count: int = 4001) -> Any:
    """Times all over a motion, both sides of its breaks among them."""
    breaks = plan.curve.breaks
    sides = np.concatenate([breaks[1:] - GAP, breaks[:-1] + GAP])
    return plan.duration * np.sort(np.concatenate([np.linspace(0, 1, count), sides]))


def place(rows: Any) -> Any:
    """Lengths of the position part of (n, 4)."""
    return np.linalg.norm(rows[:, [0, 1, 3]], axis=1)
