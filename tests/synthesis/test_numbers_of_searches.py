"""The numbers that decide where searches look, and so what they answer.

Each answer that is stated (in the docs, in reports, in saved results) comes out the same again only
with these: another number is another search. Whoever changes one has to look at the answers again.
"""

from __future__ import annotations

import dataclasses
from types import ModuleType
from typing import Any

import pytest

from paminsa_viz.synthesis import Effort
from paminsa_viz.synthesis.answer import checks, engine_check, prices
from paminsa_viz.synthesis.masses import program
from paminsa_viz.synthesis.proof import (
    bisection,
    certificate,
    evidence,
    largest,
    placement,
    regions,
)
from paminsa_viz.synthesis.search import (
    buildability,
    checkpoint,
    evaluation,
    extremes,
    front,
    kernels,
    outer,
    region,
    solve,
    trial,
    trial_masses,
)
from paminsa_viz.synthesis.volume import check, conflict, grid, margins, measure, surface, workspace

NUMBERS: dict[ModuleType, dict[str, Any]] = {
    buildability: {"RANDOM": 1000, "HEIGHTS": 81},
    evaluation: {"REFUSED": 1e9, "STAGES": 8, "CLOSER": 2, "SLOW": 1e-4},
    kernels: {"NARROWED": 24},
    solve: {"FINER": 4, "REPAIRS": 8, "REPAIR_ROUND": 40, "CLOUD": 0.01, "SLACK": 1.05},
    extremes: {"ROUNDS": 24, "STARTS": 6},
    front: {"MOST_POINTS": 200, "SLACK": 2e-3, "OTHERS": 0.8, "SAME": 1e-3},
    checkpoint: {"LEAST_POPULATION": 5, "ROUNDING": 1e-9, "LARGEST_FILE": 50_000_000},
    outer: {
        "EXPLORE": 0.6, "ROUND": 10, "STILL": 3, "PROGRESS": 2e-4, "SPREAD": 0.02,
        "STEP": 15,
    },
    region: {"TRIAL": region.Density(12, 4, 5, 5), "SPARSE": region.Density(4, 2, 3, 3)},
    trial: {"SPARE": 1e-9, "ABOVE_QUILL": 0.01},
    trial_masses: {"SPARE": 2e-9, "UNLIMITED": 1e12, "ENOUGH": 1e-7},
    program: {"FEW": 8},
    regions: {"FIRST": 4096, "KEPT": 32, "_ROUNDS": 24, "_SHRINK": 0.6, "SEED": 15},
    bisection: {
        "BATCH": 8192, "SMALLEST": 1e-9, "TURN_LENGTH": 0.1,
        "_ROUND": 1e-13, "_SPECK": 1e-14,
    },
    certificate: {"SAMPLING_TIME": 0.5, "SAMPLES": (9, 9, 9, 5), "FIXED": (False, False, False)},
    evidence: {"LARGEST": 50.0},
    largest: {
        "TOLERANCE": 1e-3, "FIRST_TOLERANCE": 0.064, "_BISECTIONS": 56, "_INSIDE": 1.0 - 1e-9,
        "NOTHING": 1e-6,
    },
    placement: {
        "RESOLUTION": grid.Resolution(60_000, 9, 2.0), "CANDIDATES": 600, "MOST_POSITIONS": 3000,
        "_SHARE": 0.4, "_ROUNDS": 100, "_STEPS": 14, "_ADDED": 32, "_DESCENTS": 12, "_KEPT": 32,
        "_DIGITS": 26, "_FOLLOWED": 400, "_NEAR": 1e-3,
    },
    check: {"FINER": 4, "_ROUNDS": 8, "SAMPLES": {False: 3, True: 8}},
    grid: {
        "COARSE": grid.Resolution(8_000, 5, 0.06), "FINE": grid.Resolution(600_000, 17, 5.0),
        "_LEAST_NODES": 300, "_FEW_NODES": 0.1,
    },
    surface: {"FACES": 20_000},
    workspace: {"DIRECTIONS": 12, "_FINE_HEADINGS": 181},
    margins: {"CHEAP": 1e-6, "_LONG_BARS": 100.0},
    conflict: {"_FEW": 12},
    measure: {
        "_BAND": 1.25, "_EACH": 2, "_NECK": 3, "_LEAST": 200, "_DEVIATIONS": 3.0, "_SEED": 5,
    },
    checks: {"DENSITY": 4, "HEADINGS": 9},
    engine_check: {"POSES": 60, "WORST": 5, "ACCEPTED": 1e-6},
    prices: {"STEP": 0.02, "AT_END": 2e-3, "STILL": 2e-4},
}  # fmt: skip


@pytest.mark.parametrize("module", NUMBERS, ids=lambda module: module.__name__.split(".")[-1])
def test_a_search_is_decided_by_the_same_numbers_in_every_version(module: ModuleType) -> None:
    assert {name: getattr(module, name) for name in NUMBERS[module]} == NUMBERS[module]


def test_a_robot_is_searched_in_so_many_generations_unless_told_otherwise() -> None:
    assert dataclasses.astuple(Effort()) == (200, 8)
