"""Every benchmark runs, at its smallest, and the list names it; figures are none of a test's."""

from __future__ import annotations

import re
import sys
from collections.abc import Callable
from functools import partial
from importlib import import_module
from pathlib import Path
from typing import Any

import pytest

from paminsa_viz.model import APPENDIX_4, Grid
from paminsa_viz.trajectory import PRESET, PRESETS, ControlMode, MotionLimits
from tests.cli.test_synthesize import CASE

pytestmark = pytest.mark.slow

FOLDER = Path(__file__).parent.parent / "benchmarks"
NAMES = sorted({path.stem for path in FOLDER.glob("*.py")} - {"__init__", "measure"})

SMALLEST: dict[str, dict[str, Any]] = {
    "accuracy_speed": {"CELLS": 6},
    "balancing_speed": {
        "workspace": lambda: Grid.over((0.0, 0.0, 0.1, -0.5), z=[-0.6, -0.4], x=[-0.1, 0.0, 0.1]),
        "motion": lambda: PRESET["arch"].build(APPENDIX_4.geometry).sample(20.0),
    },
    "calibration_speed": {"CELLS": 6},
    "certificate_speed": {"BOXES": 64, "TOLERANCES": (0.1,)},
    "clearance_speed": {"CELLS": 6},
    "code_speed": {"STATES": 64, "BUILDS": {"gcc -O2": ("gcc", "-O2")}},
    "drive_speed": {"MOTORS": 20},
    "excitation_speed": {"SECONDS": 0.1, "RUNS": ((5, 0),)},
    "identification_coverage": {"LOGS": {"8 s": (8.0, 0.5)}},
    "identification_speed": {"SECONDS": 6.0, "RATE": 100.0},
    "loads_speed": {"CELLS": 37},
    "model_speed": {"ENGINE_STATES": 3, "LARGEST": 4, "SIDES": (20,)},
    "stiffness_speed": {"CELLS": 15},
    "synthesis_speed": {"TRIALS": 3},
    "time_optimal": {
        "PATHS": 1,
        "FINER": (80, 1),
        "PRESETS": PRESETS[:2],
        "CASES": {"limits": (APPENDIX_4, MotionLimits(speed=1.0, torque=6.0))},
    },
    "trajectory_speed": {"ControlMode": tuple(ControlMode)[:1]},
}
IN_A_BROWSER = ("goals", "one_file_speed", "page_latency", "page_tasks")
"""They start explorers and browsers of their own."""

ARGUMENTS = {
    "accuracy_error": ("--boxes", "4", "--points", "9"),
    "identification_coverage": ("--motions", "2", "--noises", "1", "--cut-offs", "10"),
    "volume_error": ("--cases", "1", "--nodes", "500", "--points", "256"),
}


def once(run: Callable[[], object], **_: Any) -> float:
    """Run what is to be timed."""
    run()
    return 1.0


@pytest.mark.parametrize("name", [name for name in NAMES if name not in IN_A_BROWSER])
def test_benchmark_runs_at_its_smallest(
    name: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    module = import_module(f"benchmarks.{name}")
    for constant, value in SMALLEST.get(name, {}).items():
        monkeypatch.setattr(module, constant, value)
    if name == "synthesis_speed":
        (tmp_path / "small.toml").write_text(CASE)
        small = tmp_path / "small.toml"
        monkeypatch.setattr(module, "EXAMPLES", dict.fromkeys(("cylinder", "cell"), small))
        # what is drawn of a robot may overlap: its clearance would take longest
        monkeypatch.setattr(module, "load_case", partial(module.load_case, allow_overlap=True))
    if name == "trajectory_speed":
        short = module.PLAN.lasting(0.2)
        monkeypatch.setattr(module, "PLAN", short)
        monkeypatch.setattr(module, "SAMPLES", short.sample(100.0))
    if name == "volume_speed":
        coarse = partial(module.solve_volume, resolution=module.COARSE)
        monkeypatch.setattr(module, "solve_volume", coarse)
    for timer in ("best", "processor_time"):
        monkeypatch.setattr(module, timer, once, raising=False)
    monkeypatch.setattr(sys, "argv", [name, *ARGUMENTS.get(name, ())])
    module.main()
    assert re.search(r"^\|[^\n]*\|\n\|-[^\n]*\|\n\|", capsys.readouterr().out, re.MULTILINE)


def test_list_names_every_benchmark() -> None:
    listed = re.findall(
        r"^\| `python -m benchmarks\.(\w+)`", (FOLDER / "README.md").read_text(), re.M
    )
    assert sorted(listed) == NAMES
