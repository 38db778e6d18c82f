"""The designs that come with the program are what they claim."""

from __future__ import annotations

import runpy
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from paminsa_viz.actuation.duty import Duty, duty_cycle
from paminsa_viz.actuation.selection import size_design
from paminsa_viz.balancing import balance
from paminsa_viz.files.design_file import read_design, write_design
from paminsa_viz.files.example_designs import ExampleDesign, example_design
from paminsa_viz.model import APPENDIX_4, resized, static_imbalance, static_torques
from paminsa_viz.model.design import PARAMETER
from paminsa_viz.trajectory import PRESET

SCRIPT = Path(__file__).parents[2] / "assets" / "make_designs.py"
BALANCED = (ExampleDesign.BALANCED, ExampleDesign.PAYLOAD, ExampleDesign.COMPACT)


@pytest.fixture(scope="module")
def script() -> dict[str, Any]:
    """What the script that made them defines; nothing is searched."""
    return runpy.run_path(str(SCRIPT))


@pytest.mark.parametrize("kind", ExampleDesign)
def test_an_example_is_named_and_read_back_as_it_is_written(kind: ExampleDesign) -> None:
    design = example_design(kind)
    assert design.name
    assert (design == APPENDIX_4) == (kind is ExampleDesign.APPENDIX_4)
    assert read_design(write_design(design).encode(), "x") == design


@pytest.mark.parametrize("kind", BALANCED)
def test_balanced_examples_hold_themselves_anywhere(
    kind: ExampleDesign, script: dict[str, Any]
) -> None:
    design = example_design(kind)
    poses = script["workspace"](script["top_of"](design))
    torques = static_torques(design, poses)
    assert np.isfinite(torques).all()
    assert np.abs(torques[:, :3]).max() <= 1e-9
    assert abs(static_imbalance(design)) <= 1e-9


def test_masses_are_those_of_the_papers_balance() -> None:
    assert example_design(ExampleDesign.BALANCED) == balance(APPENDIX_4).after


def test_drives_carry_the_payload_on_the_preset_motion() -> None:
    design = example_design(ExampleDesign.PAYLOAD)
    assert design.payload.mass == 10.0
    motion = PRESET["paper-like"].build(design.geometry).sample(1000.0)
    drives = size_design(duty_cycle(design, [Duty(motion)]), design)
    for drive in drives:
        assert drive is not None
        assert drive.feasible
        assert 0.0 < drive.use <= 1.0


@pytest.mark.slow
def test_compact_robot_meets_its_needs_in_two_thirds_of_the_radius(
    script: dict[str, Any],
) -> None:
    design = example_design(ExampleDesign.COMPACT)
    poses = script["workspace"](script["top_of"](design), finer=4)
    assert script["broken"](design, poses) == 0.0
    footprint = script["footprint"]
    other = script["workspace"](script["top_of"](APPENDIX_4), finer=4)
    assert footprint(design, poses) == pytest.approx(0.482, abs=5e-4)
    assert footprint(APPENDIX_4, other) == pytest.approx(0.732, abs=5e-4)


def test_masses_of_the_compact_robot_are_those_of_its_lengths(script: dict[str, Any]) -> None:
    held = example_design(ExampleDesign.COMPACT)
    lengths = {path: held.value(path) for path in (*script["SEARCHED"], *script["FOLLOWING"])}
    made = balance(resized(APPENDIX_4, lengths)).after
    for path in PARAMETER:
        assert held.value(path) == pytest.approx(made.value(path), rel=1e-12), path


@pytest.mark.slow
def test_script_makes_the_files(script: dict[str, Any]) -> None:
    assert script["balanced"]() == example_design(ExampleDesign.BALANCED)
    assert script["heavy_payload"]() == example_design(ExampleDesign.PAYLOAD)
