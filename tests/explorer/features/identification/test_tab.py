"""The tab of identification: logs, findings, their use, the motion, and what is refused."""

from __future__ import annotations

import json
import re
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from paminsa_viz.blocks.excitation import limits_table
from paminsa_viz.blocks.identification import identification_blocks
from paminsa_viz.explorer.core import actions as poses
from paminsa_viz.explorer.core import persistence, tab_store
from paminsa_viz.explorer.core.frame import compute
from paminsa_viz.explorer.core.planning import planned
from paminsa_viz.explorer.features.identification import actions
from paminsa_viz.explorer.features.identification import files as exports
from paminsa_viz.explorer.features.identification import tab as identify_panel
from paminsa_viz.explorer.features.identification import texts as identify_text
from paminsa_viz.explorer.features.identification.solving import identify_logs, search_excitation
from paminsa_viz.explorer.kit.entries import Html
from paminsa_viz.explorer.state.identification import ExcitationJob, IdentifySettings, parse_gains
from paminsa_viz.explorer.state.outcome import Outcome, solve
from paminsa_viz.explorer.state.state import State, initial_state
from paminsa_viz.files.example_logs import ExampleLog, example_log
from paminsa_viz.identification import make_log
from paminsa_viz.model import InvalidInput, PaminsaError, static_imbalance
from paminsa_viz.plots.identification_series import log_charts
from tests.support.desk import Desk
from tests.support.raw_page import upload_messages
from tests.support.tables import assert_parts
from tests.support.tasks import delivered, finished

PANEL = (*identify_panel.LOGS, *identify_panel.EXCITE)
HEAD = "t_s,theta1_deg,theta2_deg,theta3_deg,Z_mm,torque1_Nm,torque2_Nm,torque3_Nm,force4_N\n"


def identified(state: State) -> State:
    assert state.identification.running is not None
    return finished(actions.IDENTIFY, state)


@pytest.fixture(scope="module")
def found() -> State:
    return identified(actions.use_examples(initial_state()))


def test_section_of_the_motion_says_what_it_is_for_before_its_settings() -> None:
    first = identify_panel.EXCITE[0]
    assert isinstance(first, Html)
    assert "open its log in the section Logs" in str(first.content)


@pytest.mark.slow
def test_numbers_causes_checks_and_masses_are_told(found: State) -> None:
    frame = compute(found)
    assert "Masses and friction explain the log" in identify_text.status_html(frame)
    numbers = identify_text.numbers_html(frame)
    assert numbers.count('<tr class="pv-muted"') == len(
        found.identification.result.identification.unknown
    )  # type: ignore[union-attr]
    assert "unknown" in numbers
    assert "holds" in numbers
    causes = identify_text.causes_html(frame)
    assert "Nothing in the log contradicts" in causes
    assert "N·m/rad" in causes
    assert " mm</td>" in causes
    assert not re.search(r"N m|\w_\w", re.sub("<[^>]*>", "", causes))
    assert "Payload" in identify_text.checks_html(frame)
    blocks = identification_blocks(found.identification.result)  # type: ignore[arg-type]
    for text in (numbers, causes):
        assert_parts(text, blocks)
    for made in (identify_text.checks_html, identify_text.masses_html):
        assert_parts(made(frame), blocks)
    assert '<tr class="pv-muted"' in identify_text.masses_html(frame)
    assert "example_log_payload" in identify_text.logs_html(frame)
    assert "Hz.\n<br>Logs are not kept over a reload" in identify_text.logs_html(frame)


@pytest.mark.slow
def test_charts_are_of_the_log_and_its_prediction(found: State) -> None:
    one = found.identification.result.identification  # type: ignore[union-attr]
    for actuator in range(4):
        torque, rest = log_charts(one, actuator)
        measured, predicted = (trace.values for trace in torque.traces)
        np.testing.assert_allclose(measured, one.measured[:, actuator])
        np.testing.assert_allclose(rest.traces[0].values, measured - predicted, atol=1e-12)


@pytest.mark.slow
def test_gaps_between_pieces_are_not_drawn_over() -> None:
    log = example_log()
    kept = np.r_[0:2000, 2600:5001]
    parts = make_log(log.t[kept], log.position[kept], log.torque[kept], split=True)
    state = identified(actions.use_log(initial_state(), "log", parts))
    torque, _ = log_charts(state.identification.result.identification, 0)  # type: ignore[union-attr]
    assert np.isnan(torque.traces[0].values).sum() == 1
    assert np.all(np.diff(torque.t) > 0)


@pytest.mark.slow
def test_numbers_and_residuals_are_exported(found: State) -> None:
    numbers = exports.identification_table(found, "parameters")
    assert numbers.name == "paminsa_parameters_example-log.csv"
    rows = numbers.content.decode().splitlines()
    one = found.identification.result.identification  # type: ignore[union-attr]
    assert sum(row.endswith(",no") for row in rows) == len(one.unknown)
    text = exports.identification_table(found, "residuals").content.decode()
    assert (
        len([row for row in text.splitlines() if not row.startswith("#")]) == 1 + one.signals.t.size
    )


def test_nearest_masses_become_the_design_and_can_be_saved(found: State) -> None:
    used = actions.use_design(found)
    design = used.document.design
    assert design != found.document.design
    outcome = actions.IDENTIFY.outcome(found)
    assert outcome is not None
    assert design.name == f"Identified from {outcome.job.log.name}"
    weight = found.identification.result.identification.estimate("M_p2")  # type: ignore[union-attr]
    assert abs(static_imbalance(design) - weight.value) < weight.half_width
    assert persistence.load(persistence.dump(used.document)).design == design
    other = poses.vary(used, {"links.b4": 2.0})
    assert "Changed since" in identify_text.status_html(compute(other))
    for same in (found, used):  # the design is what was found
        assert "Changed since" not in identify_text.status_html(compute(same))


def test_log_is_played_as_a_motion(found: State) -> None:
    playing = actions.use_log_motion(found)
    motion = planned(playing.document.motion, playing.document.design).trajectory
    assert playing.playback.playing
    assert motion is not None
    assert motion.name == "example_log"
    assert motion.duration == pytest.approx(20.0, abs=1.0)


def test_settings_outlive_results_and_logs(found: State) -> None:
    changed = found.updated("identification.settings", cut_off=9.0)
    assert "Changed since" in identify_text.status_html(compute(changed))
    assert changed.identification.result is found.identification.result
    closed = actions.close_logs(changed)
    assert closed.identification.log is None
    assert closed.identification.settings.cut_off == 9.0
    searching = found.updated("identification.settings", period=8.0, seconds=5.0)
    assert "Changed since" not in identify_text.status_html(compute(searching))


@pytest.mark.parametrize(
    "saved",
    [
        {"cut_off": 1e9}, {"cut_off": "9"}, {"legs": 1}, {"harmonics": 3.5}, {"gains": "1 2"},
        {"seconds": float("nan")},
    ],
    ids=str,
)  # fmt: skip
def test_impossible_saved_settings_keep_their_default(saved) -> None:
    data = json.loads(tab_store.dump(initial_state()))
    data["view"]["identification.settings"] |= saved
    restored = tab_store.restore(initial_state(), json.dumps(data))
    assert restored.identification.settings == IdentifySettings()


@pytest.mark.slow
def test_a_log_that_does_not_move_is_one_line(found: State) -> None:
    log = example_log()
    still = make_log(log.t, log.position[:1] + 0 * log.position, log.torque)
    state = identified(actions.use_log(found, "log", still))
    assert state.identification.result is None
    text = identify_text.status_html(compute(state))
    assert "Not identified" in text
    assert "hardly moves" in text
    assert state.identification.other is not None
    again = identified(actions.use_log(state, "log", example_log(ExampleLog.BEST)))
    assert again.identification.result is not None


@pytest.mark.slow
def test_a_wrong_gain_is_named_on_the_page(found: State) -> None:
    log = example_log()
    wrong = make_log(log.t, log.position, log.torque * [1.0, 1.1, 1.0, 1.0])
    state = identified(actions.use_log(initial_state(), "log", wrong))
    text = identify_text.status_html(compute(state))
    assert "Masses and friction do not explain the log" in text
    assert "M2" in text


@pytest.mark.slow
def test_torques_of_the_wrong_sign_or_unit_are_not_explained() -> None:
    """Both fit as well as the true ones: only that no robot is so tells."""
    log = example_log()

    def told(factor: float) -> State:
        scaled = make_log(log.t, log.position, factor * log.torque)
        return identified(actions.use_log(initial_state(), "log", scaled))

    frame = compute(told(-1.0))
    text = identify_text.status_html(frame)
    assert "Masses and friction do not explain the log" in text
    assert "the sign of force4" in text
    assert "Nothing in the log contradicts" not in identify_text.causes_html(frame)
    text = identify_text.status_html(compute(told(1000.0)))
    assert "Not identified" in text
    assert "check the units and gains of its torques" in text


def test_stopped_work_says_so() -> None:
    state = actions.use_log(initial_state(), "log", example_log())
    assert state.identification.running is not None
    outcome = solve(identify_logs, state.identification.running, lambda _, **__: True)
    assert outcome.result is None
    assert "stopped" in outcome.problem


def test_nothing_can_be_used_before_there_is_something() -> None:
    state = initial_state()
    for action in (
        actions.IDENTIFY.start, actions.use_design, actions.use_log_motion, actions.use_excitation,
    ):  # fmt: skip
        with pytest.raises(InvalidInput):
            action(state)
    for text in (identify_text.status_html, identify_text.numbers_html, identify_text.causes_html):
        assert text(compute(state)) == ""
    assert "Open a log" in identify_text.logs_html(compute(state))


@pytest.mark.parametrize("text", ["1 2 3", "a b c d", "1 2 3 0", "1 2 3 inf"])
def test_gains_are_four_numbers_or_none(text) -> None:
    with pytest.raises(InvalidInput, match="four numbers"):
        initial_state().updated("identification.settings", gains=text)
    assert parse_gains(" ") is None
    assert parse_gains("1, 2, 3; 40") == (1.0, 2.0, 3.0, 40.0)


def searched(state: State, **settings: Any) -> State:
    started = actions.SEARCH.start(state.updated("identification.settings", **settings))
    job = started.identification.excitation.running
    assert job is not None
    shares: list[float] = []

    def stop_soon(share: float) -> bool:
        shares.append(share)
        return len(shares) > 1

    outcome = solve(search_excitation, job, stop_soon)
    return delivered(actions.SEARCH, started, outcome)


@pytest.mark.slow
def test_motion_is_offered_with_its_limits_and_becomes_the_current_one() -> None:
    state = searched(initial_state(), period=8.0)
    text = identify_text.excitation_html(compute(state))
    assert "condition number" in text
    assert "pv-bad-text" not in text
    assert_parts(text, [limits_table(actions.excitation(state)[1])])
    used = actions.use_excitation(state)
    motion = planned(used.document.motion, used.document.design).trajectory
    assert motion is not None
    assert motion.duration == pytest.approx(16.0)
    table = exports.excitation_csv(state).content.decode()
    assert "# harmonics: 5" in table


@pytest.mark.slow
def test_a_search_without_result_says_why() -> None:
    state = initial_state()
    heavy = state.document.design.vary({"platform.mass": 400.0})
    job = ExcitationJob(heavy, state.identification.settings)
    outcome = solve(search_excitation, job)
    shown = state.updated("identification.excitation", outcome=outcome)
    assert "force of M4 is beyond its limit" in identify_text.excitation_html(compute(shown))


def test_failed_jobs_are_shown() -> None:
    state = actions.use_log(initial_state(), "log", example_log())
    job = state.identification.running
    assert job is not None
    outcome = Outcome(job, error=PaminsaError("it failed"))
    failed = delivered(actions.IDENTIFY, state, outcome)
    assert "It failed" in identify_text.status_html(compute(failed))
    failed = state.updated("identification.excitation", outcome=outcome)
    assert "It failed" in identify_text.excitation_html(compute(failed))


def test_names_from_files_are_escaped(found: State) -> None:
    log = replace(example_log(), name="<b>log</b>")
    state = actions.use_log(initial_state(), "log", log)
    assert "<b>log</b>" not in identify_text.logs_html(compute(state)).replace("<b>&lt;", "")


BAD = {
    "wrong columns": (b"t_s,a\n0,1\n", "there is no such column"),
    "radians": (
        (
            HEAD.replace("_deg", "_rad")
            + "".join(f"{i},90,0,0,280,0,0,0,200\n" for i in range(12))
        ).encode(),
        "degrees",
    ),
    "reversed times": (
        (HEAD + "1,0,0,0,280,0,0,0,200\n0.9,0,0,0,280,0,0,0,200\n" * 6).encode(),
        "times have to increase",
    ),
}  # fmt: skip


@pytest.mark.parametrize("case", BAD)
def test_bad_uploads_are_one_notice_and_change_nothing(desk: Desk, case) -> None:
    content, words = BAD[case]
    button = desk.handle("identify.log.upload")._impl.uuid
    for message in upload_messages(button, content, "log.csv"):
        desk.page.send(message)
    desk.noticed(words)
    assert desk.state.identification.log is None
