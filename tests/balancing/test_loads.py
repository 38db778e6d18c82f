"""Balancing a robot that carries an external load: constant parts of static and dynamic terms."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from paminsa_viz.balancing import (
    StaticLift,
    StaticPeak,
    StaticRms,
    TrajectoryEnergy,
    TrajectoryPeak,
    TrajectoryRms,
    optimize,
)
from paminsa_viz.balancing.changes import mass_space
from paminsa_viz.model import (
    APPENDIX_4,
    Design,
    LoadCase,
    LoadFrame,
    solve_field,
    static_torques,
    xy_grid,
)
from paminsa_viz.model.load import NO_LOAD
from paminsa_viz.trajectory import PRESET, analyze
from paminsa_viz.trajectory.integrals import time_weights
from paminsa_viz.trajectory.solved import solve_trajectory
from tests.balancing.robots import changes

LOAD = LoadCase(30.0, -20.0, -80.0, moment_z=4.0, point_x=0.05, frame=LoadFrame.PLATFORM)
DESIGN = replace(APPENDIX_4, load=LOAD)
AXIS = np.linspace(-0.08, 0.08, 9)
FIELD = solve_field(DESIGN.geometry, xy_grid(AXIS, AXIS, 0.2, -0.5))
PATH = PRESET["paper-like"].build(DESIGN.geometry).sample(100)


SOLVED = solve_trajectory(DESIGN.geometry, PATH)
TERMS = (
    StaticPeak(FIELD), StaticRms(FIELD), StaticLift(FIELD),
    TrajectoryPeak(SOLVED), TrajectoryRms(SOLVED), TrajectoryEnergy(SOLVED),
)  # fmt: skip


def measured(design: Design) -> list[float]:
    """The terms of a design by statics and inverse dynamics, in their order."""
    torque = static_torques(design, FIELD.grid.poses())
    moving = analyze(design, PATH)
    weight = time_weights(PATH.t) / PATH.duration
    return [
        np.abs(torque[..., :3]).max(),
        np.sqrt((torque[..., :3] ** 2).mean()),
        np.abs(torque[..., 3]).max(),
        np.abs(moving.torque[:, :3]).max(),
        np.sqrt((weight @ moving.torque[:, :3] ** 2).mean()),
        sum(motor.driven for motor in moving.summary),
    ]


@pytest.mark.slow
@pytest.mark.parametrize("number", range(len(TERMS)), ids=[term.label for term in TERMS])
def test_terms_and_their_optimum_have_the_torques_under_the_load(number: int) -> None:
    term = TERMS[number]
    space = mass_space(DESIGN, changes())
    value = term.convex_term(space).value(space.before)
    assert value == pytest.approx(measured(DESIGN)[number], rel=1e-4)
    found = optimize(DESIGN, changes(), term)
    assert found.gap <= 1e-8 * abs(found.values[0].before)
    assert found.values[0].after == pytest.approx(measured(found.after)[number], rel=1e-4)
    bare = optimize(replace(DESIGN, load=NO_LOAD), changes(), term)
    assert bare.values[0].after != pytest.approx(found.values[0].after, rel=1e-3)
    # what is best without the load is no better with it
    assert measured(replace(bare.after, load=LOAD))[number] >= found.objective * (1 - 1e-6)
