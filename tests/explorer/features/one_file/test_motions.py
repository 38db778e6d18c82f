"""Motions of the page in one file, worked out in JavaScript, are those of `trajectory`."""

from __future__ import annotations

import re
import shutil
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from paminsa_viz.explorer.features.one_file import one_file
from paminsa_viz.explorer.kit.robot_texts import decimals, millimeter_decimals
from paminsa_viz.explorer.state.document import Document
from paminsa_viz.model import APPENDIX_4, Design, KneeBranch, LoadCase, backend, torque_breakdown
from paminsa_viz.trajectory import PRESETS
from tests.explorer.features.one_file.node import run_in_node
from tests.support.samples import prototype_times, random_design

RUN = """
return given.map((text) => {
  const robot = robotOf(checkedDocument(text));
  return PAGE.motions.presets.map((preset) => {
    const motion = motionOf(robot, preset);
    return [preset.key, motion.duration, [0, 0.13, 0.5, 0.77, 1].map((share) => {
      const state = motion.at(share * motion.duration);
      const parts = torqueParts(robot, state);
      return [state.pose, state.velocity, state.acceleration,
        ...CAUSES.map((cause) => parts[cause]), parts.total];
    })];
  });
});
"""

SHARES = np.array([0.0, 0.13, 0.5, 0.77, 1.0])

NOT_THERE = {"waypoints"}
"""Presets that the page leaves out."""


def designs() -> list[Design]:
    rng = np.random.default_rng(11)
    rubbing = {"friction.viscous_rotary": 0.2, "friction.coulomb_linear": 3.0}
    load = LoadCase(*rng.normal(size=9))
    return [
        APPENDIX_4,
        replace(APPENDIX_4.vary(rubbing), load=load).with_knee(KneeBranch.UPPER),
        random_design(rng),
        random_design(rng),
    ]


@pytest.mark.slow
@pytest.mark.skipif(shutil.which("node") is None, reason="no node here")
def test_states_and_torques_by_cause_are_those_of_python(tmp_path: Path) -> None:
    robots = designs()
    documents = [Document(design=each, pose=(0.0, 0.0, 0.0, 0.0)) for each in robots]
    finite = 0
    for robot, found in zip(robots, run_in_node(RUN, documents, tmp_path), strict=True):
        assert [key for key, *_ in found] == [p.key for p in PRESETS if p.key not in NOT_THERE]
        for key, duration, rows in found:
            plan = next(p for p in PRESETS if p.key == key).build(robot.geometry)
            assert duration == pytest.approx(plan.duration, rel=1e-12)
            states = plan.at(SHARES * plan.duration)
            with backend.use_numpy():
                parts = torque_breakdown(robot, *states)
            wanted = np.stack(
                [*states, parts.gravity, parts.inertial, parts.velocity, parts.friction,
                 parts.load, parts.total], axis=1,
            )  # fmt: skip
            got = np.array(rows, dtype=float)
            reached = np.isfinite(wanted).all(axis=(1, 2))
            finite += int(reached.sum())
            np.testing.assert_allclose(got[reached], wanted[reached], rtol=1e-9, atol=1e-9)
    assert finite > 100


@pytest.mark.skipif(shutil.which("node") is None, reason="no node here")
def test_numbers_of_any_robot_have_the_decimals_of_the_served_page(tmp_path: Path) -> None:
    robots = [prototype_times(factor) for factor in (0.01, 0.1, 1.0, 5.0)]
    documents = [Document(design=each, pose=(0.0, 0.0, 0.0, 0.0)) for each in robots]
    run = "return given.map((text) => robotOf(checkedDocument(text)).spare);"
    found = run_in_node(run, documents, tmp_path)
    usual = decimals(APPENDIX_4)
    for robot, spare in zip(robots, found, strict=True):
        shown = [
            max(0, many + spare[of]) for many, of in zip(usual, ("torque", "force"), strict=True)
        ]
        assert shown == list(decimals(robot))
        assert 1 + spare["place"] == millimeter_decimals(robot.geometry)
    script = one_file(documents[2])
    (many,) = re.findall(r"number\(robot\.imbalance, (\d) \+ robot\.spare\.force\)", script)
    assert int(many) == usual[1] + 1  # as M_p2 is written there
