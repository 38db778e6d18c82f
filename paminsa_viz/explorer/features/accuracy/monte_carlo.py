"""Random robots within the tolerances: their settings, the job, the errors found."""

from __future__ import annotations

from dataclasses import replace

from viser import Icon

from paminsa_viz.blocks.accuracy import robots_blocks
from paminsa_viz.blocks.kinds import Note
from paminsa_viz.explorer.core.frame import Frame
from paminsa_viz.explorer.core.place import Place
from paminsa_viz.explorer.kit.entries import Answer, Button, Entry, Html
from paminsa_viz.explorer.kit.setting_inputs import SettingInputs
from paminsa_viz.explorer.kit.task import Task
from paminsa_viz.explorer.kit.text import blocks_html
from paminsa_viz.explorer.state.monte_carlo import MonteCarloJob, MonteCarloSettings
from paminsa_viz.explorer.state.state import State
from paminsa_viz.model import Design
from paminsa_viz.model.arrays import Pose
from paminsa_viz.precision.leg_lengths import lengths_only
from paminsa_viz.precision.manufacture import MonteCarlo, monte_carlo
from paminsa_viz.progress import Progress


def shown_lengths(frame: Frame) -> tuple[Design, Pose]:
    """Return what errors by manufacture depend on: lengths and tolerances, and the pose."""
    return toleranced(frame.shown_design), frame.state.last_reachable.pose


def toleranced(design: Design) -> Design:
    """Return a design with nothing of its own but lengths, their deviations, and tolerances."""
    return replace(lengths_only(design), tolerances=design.tolerances)


def draw_robots(job: MonteCarloJob, progress: Progress) -> MonteCarlo:
    """Draw the robots.

    Raises:
        PaminsaError: If they are too many, or the pose has none.
    """
    return monte_carlo(
        job.design, job.pose, robots=job.robots, seed=job.seed, block=512,
        progress=progress,
    )  # fmt: skip


def _job(state: State) -> MonteCarloJob:
    """Return the job for the pose where the robot is: only lengths and tolerances count."""
    own, pose = state.monte_carlo.settings, state.last_reachable.pose
    return MonteCarloJob(toleranced(state.shown_design), pose, own.robots, own.seed)


DRAW = Task(Place(lambda state: state.monte_carlo), _job, draw_robots)
"""Draws robots at random."""


def monte_carlo_html(frame: Frame) -> str:
    """Return what was found of random robots."""
    outcome = DRAW.outcome(frame.state)
    if outcome is None:
        return ""
    found = [Note(outcome.problem)] if outcome.result is None else robots_blocks(outcome.result)
    return blocks_html("manufacture-robots", *found, stale=DRAW.stale_text(frame.state))


setting = SettingInputs("manufacture", "monte_carlo.settings", MonteCarloSettings)
"""Inputs of the settings, those of tolerances among them."""

MONTE_CARLO: tuple[Entry, ...] = (
    setting("robots", undo=False),
    setting("seed", undo=False),
    *DRAW.buttons(
        Button(
            "manufacture.start", "Run Monte Carlo", icon=Icon.DICE, effect=DRAW.start, undo=False,
            hint="Draws lengths within the tolerances and solves each robot, at this pose",
        ),
    ),
    DRAW.worker,
    Answer(
        "manufacture.random_answer", "Random robots", found=DRAW.outcome,
        entries=(Html("manufacture.found", content=monte_carlo_html, idle=True),),
    ),
)  # fmt: skip
