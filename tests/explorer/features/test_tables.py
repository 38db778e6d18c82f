"""What the page shows at a pose are the tables that the report and the commands print."""

from __future__ import annotations

from collections.abc import Callable, Iterable

import numpy as np
import pytest

from paminsa_viz.blocks import accuracy, loads, stiffness
from paminsa_viz.blocks.kinds import Block
from paminsa_viz.elastostatics.joint_forces import joint_forces
from paminsa_viz.elastostatics.sideways import sideways_forces
from paminsa_viz.elastostatics.stiffness import platform_stiffness
from paminsa_viz.explorer.core.frame import Frame, compute
from paminsa_viz.explorer.features.accuracy import manufacture, monte_carlo
from paminsa_viz.explorer.features.accuracy import tab as accuracy_tab
from paminsa_viz.explorer.features.loads import tab as loads_tab
from paminsa_viz.explorer.features.stiffness import tab as stiffness_tab
from paminsa_viz.explorer.features.stiffness.solving import analyze_elasticity
from paminsa_viz.explorer.state.outcome import solve
from paminsa_viz.explorer.state.state import State
from paminsa_viz.explorer.state.stiffness import ElasticJob
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.design import Design
from paminsa_viz.precision.drive_errors import drive_errors
from tests.support.samples import random_design, random_poses
from tests.support.scene import frame_at
from tests.support.tables import assert_parts
from tests.support.tasks import finished

Case = tuple[Callable[[Frame], str], Callable[[Design, Array], Iterable[Block]]]


def loads_at(design: Design, pose: Array) -> list[Block]:
    return loads.pose_blocks(joint_forces(design, pose), sideways_forces(design, pose))


def stiffness_at(design: Design, pose: Array) -> list[Block]:
    return stiffness.stiffness_blocks(design, platform_stiffness(design, pose))


TABLES: tuple[Case, ...] = (
    (
        accuracy_tab.pose_html,
        lambda design, pose: [
            accuracy.drive_errors_table(drive_errors(design.geometry, design.accuracy, pose))
        ],
    ),
    (manufacture.tolerances_html, accuracy.manufacture_blocks),
    (loads_tab.joints, loads_at),
    (loads_tab.bars, loads_at),
    (stiffness_tab.result_html, stiffness_at),
)
"""Texts of the page at a pose, and the blocks of the report and of commands they are parts of."""


def shown(state: State, leg: int) -> State:
    """Return a state with its stiffness, and the loads of a leg chosen."""
    state = state.updated("loads.settings", leg=leg)
    job = ElasticJob(state.document.design, state.last_reachable.pose, "load")
    return stiffness_tab.ANALYSIS.deliver(state, solve(analyze_elasticity, job))


@pytest.mark.slow
def test_tables_of_the_page_are_parts_of_those_of_the_report() -> None:
    random = np.random.default_rng(7)
    for leg in range(3):
        design = random_design(random)
        pose = random_poses(random, design)[0]
        frame = compute(shown(frame_at(pose, design).state, leg))
        for text, blocks in TABLES:
            part = text(frame).replace(f"<td>M{leg + 1}</td>", "<td>Mk</td>")
            assert_parts(part, blocks(design, pose))


def test_robots_drawn_at_random_are_those_that_the_command_prints() -> None:
    random = np.random.default_rng(8)
    design = random_design(random)
    state = frame_at(random_poses(random, design)[0], design).state
    state = state.updated("monte_carlo.settings", robots=20, seed=3)
    state = finished(monte_carlo.DRAW, monte_carlo.DRAW.start(state))
    blocks = accuracy.robots_blocks(monte_carlo.DRAW.required(state, "", "")[1])
    assert_parts(monte_carlo.monte_carlo_html(compute(state)), blocks)
