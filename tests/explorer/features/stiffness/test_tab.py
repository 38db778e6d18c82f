"""The tab Stiffness: readouts, what to stiffen first, live results, and poses without any."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from paminsa_viz.elastostatics.stiffness import compensate, platform_stiffness
from paminsa_viz.elastostatics.vibration import first_frequencies
from paminsa_viz.explorer.core import actions
from paminsa_viz.explorer.core.frame import compute
from paminsa_viz.explorer.features.stiffness import tab as panel
from paminsa_viz.explorer.features.stiffness.solving import analyze_elasticity
from paminsa_viz.explorer.kit.task import FollowerRunner
from paminsa_viz.explorer.state.outcome import Outcome, solve
from paminsa_viz.explorer.state.state import State, initial_state
from paminsa_viz.explorer.state.stiffness import CASES, ElasticJob, ElasticResult
from paminsa_viz.model import APPENDIX_4, InvalidInput
from paminsa_viz.model.elastic import BARS
from paminsa_viz.units import number
from tests.support.scene import POSE, frame_at
from tests.support.tables import tables_in, value

PATH = "stiffness.outcome"


def analyzed(state: State) -> State:
    job = ElasticJob(
        compute(state).shown_design, state.last_reachable.pose, state.stiffness.settings.case
    )
    return panel.ANALYSIS.deliver(state, solve(analyze_elasticity, job))


def loaded(case: str = "load") -> State:
    design = APPENDIX_4.vary({"payload.mass": 10.0})
    return analyzed(frame_at(POSE, design).state.updated("stiffness.settings", case=case))


def test_readouts_are_the_models() -> None:
    state = loaded()
    design, text = state.document.design, panel.result_html(compute(state))
    stiffness = platform_stiffness(design, POSE)
    twist = stiffness.deflection()
    directions, deflected, frequencies = tables_in(text)
    assert directions[0][:2] == ["Stiffness", "Whole robot"]
    assert directions[1][0] == "x [N/mm]"
    assert value(directions[1][1]) == pytest.approx(1e-3 * stiffness.along(0), rel=1e-3)
    assert value(deflected[1][3]) == pytest.approx(1e3 * twist[2], rel=5e-3)
    assert f"a tilt of {number(1e3 * np.hypot(*twist[3:5]), 3)} mrad" in text
    first = float(first_frequencies(design, POSE))
    assert value(frequencies[1][1]) == pytest.approx(first, rel=1e-3)
    assert [len(row) for row in frequencies] == [3] * 7  # six beside each other are cut off
    for key in ("stiffness_x", "stiffness_theta", "stiffness_tilt", "stiffness_horizontal"):
        assert f'data-paminsa-value="{key}"' in text
    assert text.count('data-paminsa-value="frequency_1"') == 1


@pytest.mark.parametrize("case", CASES)
def test_shares_are_sorted_and_complete(case: str) -> None:
    state = loaded(case)
    text = panel.shares_html(compute(state))
    assert CASES[case][0] in text
    (rows,) = tables_in(text)
    shown = [value(share) for *_, share in rows]
    assert shown == sorted(shown, reverse=True)
    assert sum(shown) == pytest.approx(100.0, abs=1.0)


def test_without_a_load_there_is_no_deflection() -> None:
    state = analyzed(frame_at(POSE).state)
    assert "nothing is deflected" in panel.result_html(compute(state))
    assert panel.shares_html(compute(state)) == ""


def test_poses_that_are_not_held_say_why() -> None:
    pose = (0.0, 0.0, float(np.arccos(0.1 / 0.35)), -0.5)
    found = solve(analyze_elasticity, ElasticJob(APPENDIX_4, pose, "x"))
    assert found.result is None
    state = panel.ANALYSIS.deliver(frame_at(pose).state, found)
    assert "No stiffness at this pose" in panel.result_html(compute(state))
    weak = APPENDIX_4.vary({"elastic.drive_rotary": 1.0, "payload.mass": 20.0})
    pushed = solve(analyze_elasticity, ElasticJob(weak, (0.08, 0.05, 0.6, -0.5), "load"))
    assert pushed.result is not None
    assert pushed.result.frequencies == ()
    held = frame_at((0.08, 0.05, 0.6, -0.5), weak).state
    assert "no natural frequencies" in panel.result_html(
        compute(panel.ANALYSIS.deliver(held, pushed))
    )


def test_numbers_of_another_pose_or_design_are_gray() -> None:
    state = loaded()

    def shown(state: State) -> str:
        frame = compute(state)
        texts = panel.result_html(frame), panel.shares_html(frame)
        assert len({"pv-stale" in text for text in texts}) == 1
        return texts[0]

    assert "pv-stale" not in shown(state)
    for change in (
        lambda state: actions.move(state, x=0.02),
        lambda state: actions.vary(state, {"payload.mass": 3.0}),
    ):
        changed = change(state)
        assert "pv-stale" in shown(changed)
        assert "pauses" not in shown(changed)
        assert "when the motion pauses" in shown(changed.updated("playback", playing=True))
        assert shown(analyzed(changed)).count("pv-stale") == 0


def test_a_tube_without_a_wall_is_refused() -> None:
    entry = panel.elastic_slider("b4_inner")
    with pytest.raises(InvalidInput, match="inner diameter"):
        entry.apply(initial_state(), 0.05)
    changed = panel.elastic_slider("b4_outer").apply(initial_state(), 0.05)
    assert changed.document.design.elastic.b4_outer == 0.05
    names = ("b4_outer", "b4_inner")
    assert set(panel._resets(names, changed)) == {"Default"}
    reset: Any = panel._resets(names, changed)["Default"]
    assert reset(changed).document.design == APPENDIX_4


def test_what_tubes_cannot_match_is_said() -> None:
    text = panel.sections_html(compute(initial_state()))
    assert "3.3, 2.1, 7.4, 3.3 times" in text
    assert "section values" not in text
    given = actions.vary(initial_state(), {"elastic.b4_inertia_in": 1e-7})
    assert "B4: section values" in " ".join(panel.sections_html(compute(given)).split())
    light = actions.vary(initial_state(), {"links.b4": 0.0672})
    assert "(B4 10 times as much)" in panel.sections_html(compute(light))
    assert "inertias" not in panel.sections_html(compute(light))


def test_joints_and_sections_that_are_left_open_are_zero() -> None:
    state = initial_state()
    joint = panel._joint("guide")
    assert joint.read(state) == 0.0
    soft = joint.apply(state, 1e7)
    assert soft.document.design.elastic.guide == 1e7
    assert joint.apply(soft, 0.0).document.design == APPENDIX_4
    section = panel._section("inertia_in", "I", 1.0)
    given = section.apply(state.updated("stiffness.settings", bar="b8"), 1e-7)
    assert given.document.design.elastic.b8_inertia_in == 1e-7
    assert section.read(given) == 1e-7
    assert section.read(given.updated("stiffness.settings", bar="b4")) == 0.0


def test_motors_that_compensate_are_the_models() -> None:
    state = loaded()
    moved = 1e3 * compensate(state.document.design, POSE).actuators
    assert f"M4 {number(moved[3], 3)} mm" in panel.result_html(compute(state))


def test_only_what_is_shown_or_elastic_is_analyzed_while_dragging() -> None:
    session: Any = SimpleNamespace(closed=True)
    analyzer = FollowerRunner(session, panel.ANALYSIS)
    jobs: list[ElasticJob] = []
    state = frame_at(POSE).state

    def draw(state: State, dragging: bool) -> int:
        known = None if not jobs else Outcome[ElasticJob, ElasticResult](jobs[-1])
        analyzer.draw(compute(state.updated("stiffness", outcome=known)), dragging)
        run = analyzer.background.wanted
        if run is not None and run.job not in jobs:
            jobs.append(run.job)
        return len(jobs)

    assert draw(state, True) == 0
    assert draw(state, False) == 1
    assert draw(state, False) == 1
    moved = actions.move(state, x=0.04)
    assert draw(moved, True) == 1
    assert draw(moved, False) == 2
    thicker = actions.vary(moved, {"elastic.b4_outer": 0.045})
    assert draw(thicker, True) == 3
    animated = actions.set_layers(thicker, mode_shape=True)
    assert draw(actions.move(animated, x=0.05), True) == 4
    assert jobs[-1].design.elastic.b4_outer == 0.045


def test_every_tube_has_its_sliders() -> None:
    names = {name for bar in BARS for name in (f"{bar}_outer", f"{bar}_inner")}
    assert names < set(panel.SLIDERS)
