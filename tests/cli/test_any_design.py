"""Every design that its ranges allow is worked on, or refused in one line, by every command."""

from __future__ import annotations

import contextlib
import io
import os
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, example, given, settings

from paminsa_viz.balancing import SpringPlace, at_joint, fit_springs, on_slider
from paminsa_viz.cli import main
from paminsa_viz.errors import PaminsaError
from paminsa_viz.files.design_file import save_design
from paminsa_viz.model import APPENDIX_4, Design
from paminsa_viz.model.design import PARAMETER
from tests.support.commands import write_short_motion
from tests.support.samples import edge_designs

LENGTHS = tuple(path for path in PARAMETER if path.startswith("geometry."))

COMMANDS = (
    "verify --poses 5 --file short.csv",
    "export --mjcf out.xml",
    "export --mjcf out.xml --motors",
    "loads",
    "accuracy",
    "stiffness --payload 10",
    "clearance",
    "balance",
    "balance --rail b3 7 0 200 5",
    "design show d.toml",
    "map --cells 12 --out map.csv",
    "trajectory --rate 50 --out motion.csv",
    "requirements check --require condition<=20 --cylinder 100 100 --center 0 0 -600",
    "code --out code",
    "calibrate --propose 20 --out poses.csv",
)
"""Commands that take no long time; a design is added where it is not named."""

OF_BODIES = ("export --glb out.glb", "page --out page.html")
"""Commands that make all bodies, which the lengths alone decide."""


def attempt(command: str) -> None:
    """Run a command on d.toml: it answers, or refuses in one line."""
    words = command.split() + ([] if "d.toml" in command else ["--design", "d.toml"])
    out, err = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
        code = main(words)
    assert code in (0, 1, 2)
    if code == 2:
        assert err.getvalue().count("\n") == 1, err.getvalue()
        assert not Path("out.xml").exists()


@pytest.mark.slow
@settings(max_examples=12, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(design=edge_designs() | edge_designs(LENGTHS))
@example(design=APPENDIX_4.vary({"geometry.shaft_length": 0.0}))
@example(design=APPENDIX_4.vary({"geometry.platform_radius": 0.35}))
def test_every_command_answers_or_refuses_in_one_line(
    design: Design, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, mujoco: Any
) -> None:
    monkeypatch.chdir(tmp_path)
    save_design(design, "d.toml")
    write_short_motion(Path("short.csv"), 0.1)
    for command in COMMANDS:
        attempt(command)
        if Path("out.xml").exists():
            mujoco.MjModel.from_xml_path("out.xml")
            os.remove("out.xml")


@pytest.mark.slow
@settings(max_examples=3, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(design=edge_designs(LENGTHS))
@example(design=APPENDIX_4.vary({"geometry.shaft_length": 0.0}))
def test_bodies_are_written_or_refused_in_one_line(
    design: Design, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    save_design(design, "d.toml")
    for command in OF_BODIES:
        attempt(command)


@pytest.mark.slow
@settings(max_examples=1, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(design=edge_designs())
@pytest.mark.usefixtures("without_pictures")
def test_report_is_written_or_refused_in_one_line(
    design: Design, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    save_design(design, "d.toml")
    attempt("report --no-verify --out report.html")


@pytest.mark.slow
def test_report_with_its_pictures_is_written_without_shafts(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    save_design(APPENDIX_4.vary({"geometry.shaft_length": 0.0}), "d.toml")
    attempt("report --no-verify --out report.html")
    assert Path("report.html").exists()


@pytest.mark.slow
@given(design=edge_designs(LENGTHS))
@example(design=APPENDIX_4.vary({"geometry.platform_radius": 0.35}))
@example(design=APPENDIX_4.vary({"geometry.magnification": 1.35}))
def test_springs_are_fitted_or_refused(design: Design) -> None:
    place = SpringPlace(on_slider(0.3), at_joint(9))
    pose = np.random.default_rng(0).uniform(-1, 1, (60, 4)) * [0.1, 0.1, 0.2, 0.6]
    with np.errstate(all="ignore"), contextlib.suppress(PaminsaError):
        fit_springs(design, [place], pose)
    with pytest.raises(PaminsaError):
        fit_springs(design, [place], pose[:0])
