"""Words, marks and data of results that are made up: every case of each, and no two numbers alike.

What a cell says follows from one field of the result, whatever a solver would find.
"""

from __future__ import annotations

import math
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from paminsa_viz.balancing import whole_mass
from paminsa_viz.blocks import clearance as clearance_words
from paminsa_viz.blocks import trajectory
from paminsa_viz.blocks.balance import mass_facts
from paminsa_viz.blocks.kinds import Table
from paminsa_viz.blocks.trajectory import (
    compared_data,
    crossings_table,
    margin_text,
    passages_blocks,
    published_differences,
    published_notes,
    reference_note,
    shortest_data,
    simulation_data,
    simulation_notes,
    trajectory_blocks,
    trajectory_data,
    trajectory_facts,
)
from paminsa_viz.clearance import PairGroup
from paminsa_viz.model.design import APPENDIX_4
from paminsa_viz.model.drive import ACTUATORS
from paminsa_viz.model.reach import Limit
from paminsa_viz.model.statics import static_imbalance
from paminsa_viz.plots import caption
from paminsa_viz.trajectory import (
    PRESET,
    CrossingDrift,
    ShortestMotion,
    ShortestStretch,
    TrajectoryAnalysis,
    analyze,
)
from paminsa_viz.trajectory.check import PathEvent
from paminsa_viz.units import NONE
from tests.blocks.said import cells, said

# --------------------------------------------------------------------------------------- clearance


def distances(least: Any, pair: Any) -> Any:
    """A clearance of poses with pairs (a of leg 1, b), (a of leg 2, b), (M1, c)."""
    names = (("a of leg 1", "b"), ("a of leg 2", "b"), ("M1", "c"))
    return clearance_words.Clearance(
        SimpleNamespace(names=names), np.array(least, float), np.array(pair),  # type: ignore
        np.zeros((*np.shape(pair), 2, 3)),
    )  # fmt: skip


def test_nearest_bodies_of_many_poses_are_counted_by_kind() -> None:
    over = distances([0.004, 0.002, np.nan, -0.003, 0.01, 0.02], [0, 1, -1, 2, 0, 2])
    kinds = clearance_words.nearest_kinds(over)
    assert kinds == [(("a", "b"), 3, 0.002), (("M", "c"), 2, -0.003)]
    note, table = clearance_words.region_blocks(over)
    text = "5 of 6 poses can be taken; bodies overlap in 20.0 % of them."
    assert said([note]) == [(text, "warn")]
    assert cells(table) == [("a", "b", "3", "2 mm"), ("M", "c", "2", "−3 mm")]
    note, _ = clearance_words.region_blocks(over, 0.01, "samples")
    text = "5 of 6 samples can be taken; bodies are less than 10 mm apart in 60.0 % of them."
    assert said([note]) == [(text, "warn")]
    apart = distances([0.004, 0.002], [0, 1])
    assert said(clearance_words.region_blocks(apart))[0][1] == "ok"
    none = distances([np.nan, np.nan], [-1, -1])
    assert said(clearance_words.region_blocks(none)) == [("0 of 2 poses can be taken.", "warn")]
    many = said(clearance_words.region_blocks(distances([0.004] * 1200 + [np.nan], [0] * 1201)))
    assert many[0][0].startswith("1,200 of 1,201 poses can be taken; ")
    whole = clearance_words.region_blocks(distances([0.004] * 1200, [0] * 1200))[1]
    assert cells(whole)[0][2] == "1,200"
    data = clearance_words.clearance_data(APPENDIX_4, 0, {}, distances(np.nan, -1), over, 0.005)
    assert data["least"] is None
    assert (data["poses"]["drawn"], data["poses"]["reached"]) == (6, 5)
    assert data["poses"]["below"] == 3
    assert data["poses"]["nearest"][1] == {"bodies": ("M", "c"), "poses": 2, "least_m": -0.003}
    here = distances(0.004, 1)
    groups = dict(zip(PairGroup, [here] + [distances(np.nan, -1)] * len(PairGroup)))  # noqa: B905
    data = clearance_words.clearance_data(APPENDIX_4, 0, groups, here, None, 0.005)
    assert data["least"]["bodies"] == ("a of leg 2", "b")
    assert data["least"]["distance_m"] == 0.004
    assert "poses" not in data
    table, note = clearance_words.pose_blocks(APPENDIX_4, groups, here)
    assert cells(table) == [(next(iter(PairGroup)).value, "a of leg 2", "b", "4 mm")]
    assert said([note]) == [("Least clearance: 4 mm, a of leg 2 and b.", "ok")]
    kinds = [clearance_words.verdict(d, ("a", "b"), 0.005).kind for d in (-1e-3, 4e-3, 5e-3)]
    assert kinds == ["bad", "warn", "ok"]
    assert clearance_words.verdict(np.nan, ("", "")).kind == "muted"
    assert clearance_words.verdict(4e-3, ("a", "b")).kind == "ok"
    assert clearance_words.verdict(0.0, ("a", "b"), 0.005).kind == "warn"
    assert (table.words, clearance_words.region_blocks(over)[1].words) == (3, 2)  # type: ignore
    first = distances(0.004, 0)
    table, note = clearance_words.pose_blocks(APPENDIX_4, dict.fromkeys(PairGroup, first), first)
    assert len(table.rows) == len(PairGroup)  # type: ignore
    assert said([note])[0][0].endswith("a of leg 1 and b.")
    data = clearance_words.clearance_data(APPENDIX_4, 0, {}, first, over, 0.004)
    assert data["least"]["bodies"] == ("a of leg 1", "b")
    assert data["poses"]["below"] == 2


def test_one_pose_that_can_be_taken_is_enough_for_a_table() -> None:
    note, table = clearance_words.region_blocks(distances([np.nan, 0.004], [-1, 1]))
    assert said([note])[0][0].startswith("1 of 2 poses can be taken; bodies overlap in 0.0 %")
    assert cells(table) == [("a", "b", "1", "4 mm")]


def test_most_kinds_of_bodies_are_listed_up_to_a_number() -> None:
    count = clearance_words.MOST + 3
    over = distances(np.arange(count) * 1e-3, np.arange(count))
    letters = "abcdefghijklmnopqrstuvwxyz"
    object.__setattr__(
        over, "shapes", SimpleNamespace(names=[(letters[i], "x") for i in range(count)])
    )
    _, table = clearance_words.region_blocks(over)
    assert len(cells(table)) == clearance_words.MOST


# -------------------------------------------------------------------------------------- trajectory

POSE = (0.01, 0.02, 0.1, -0.5)


def test_shortest_durations_as_data() -> None:
    plan: Any = SimpleNamespace(duration=1.0)
    stretch = ShortestStretch(plan, "speed of M1", 3.0, "rad/s", 0.5)
    assert shortest_data(stretch) == {
        "quantity": "speed of M1", "limit": 3.0, "unit": "rad/s", "t_s": 0.5,
    }  # fmt: skip
    best = ShortestMotion(plan, "speed of M1", 3.0, "rad/s", 0.5, 1.25, "why")
    assert shortest_data(best) == {**shortest_data(stretch), "stretched_s": 1.25, "note": "why"}


def checked_so(analysis: TrajectoryAnalysis, **events: PathEvent) -> TrajectoryAnalysis:
    solved = replace(analysis.solved, check=replace(analysis.check, **events))  # type: ignore
    return replace(analysis, solved=solved)


def test_a_motion_that_can_be_run_or_not() -> None:
    motion = PRESET["arch"].build(APPENDIX_4.geometry).sample(20)
    whole = analyze(APPENDIX_4, motion)
    assert whole.check.first is None
    near = PathEvent(0.25, Limit.STRETCHED, 1, 0.0123, POSE)
    for leg, who in ((1, ", leg 2"), (0, ", leg 1"), (-1, "")):
        one = checked_so(whole, closest=replace(near, leg=leg))
        notes = said(trajectory_blocks(one))
        noun = Limit.STRETCHED.noun
        assert notes[1] == (
            f"The robot can run it. It comes nearest to a limit ({noun}{who}) at 0.25 s, with "
            "12.3 mm to spare.", "ok",
        )  # fmt: skip
        data = trajectory_data(one)
        assert data["closest"]["leg"] == (leg + 1 if leg >= 0 else None)
        assert data["failure"] is None
        assert data["closest"]["margin_m"] == 0.0123
    singular = replace(near, limit=Limit.SINGULAR, leg=-1)
    text = margin_text(checked_so(whole, closest=singular).check)
    assert text.endswith("12.3 mm to spare; a turn counts as the path of the joints 5.")
    assert said([reference_note(whole)]) == [('reference "Appendix 4": can run it too', "ok")]
    failed = checked_so(whole, first=near)
    notes = said(trajectory_blocks(failed))
    assert notes[1][1] == "bad"
    assert notes[1][0].endswith("The numbers are of the time before.")
    assert said([reference_note(failed)])[0][1] == "bad"
    data = trajectory_data(failed)["failure"]
    assert (data["t_s"], data["leg"], data["pose"]) == (0.25, 2, POSE)
    assert data["explanation"] == near.explanation


def test_a_motion_beside_others_with_its_figures(monkeypatch: pytest.MonkeyPatch) -> None:
    """Robots that cannot begin it have no rows, and the motion itself no figures then."""
    motion = PRESET["arch"].build(APPENDIX_4.geometry).sample(20)
    whole = analyze(APPENDIX_4, motion)
    far = motion.pose + np.array([2.0, 0.0, 0.0, 0.0])
    nowhere = analyze(APPENDIX_4, replace(motion, pose=far))
    others = {"one": whole, "two": None, "three": nowhere}
    for given, names in ((None, [""]), (others, ["", ", one"])):
        table: Any = trajectory_blocks(whole, given)[-1]
        assert [row.cells[0] for row in table.rows] == [
            f"{name}{of}" for of in names for name in ACTUATORS
        ]
    assert said(trajectory_blocks(whole))[0][0].startswith(f"“{motion.name}” ({motion.kind}): ")
    nameless = replace(whole, solved=replace(
        whole.solved, trajectory=replace(motion, kind="")))  # fmt: skip
    text = said(trajectory_blocks(nameless))[0][0]
    assert text == f"“{motion.name}”: {motion.duration:.4g} s, {motion.size} samples."
    drawn: list[Any] = []
    monkeypatch.setattr(trajectory, "series_figure", lambda *a, **k: drawn.append((*a, k)))
    assert trajectory.motion_figures(nowhere) == []
    assert len(trajectory.motion_figures(whole)) == 4
    assert [kind for kind, *_ in drawn] == ["pose", "torques", "breakdown", "power"]
    assert [options["caption"] for *_, options in drawn] == [False, True, False, False]
    unbounded = SimpleNamespace(t=0.123456, locus=SimpleNamespace(label="circle"), residual=0.12345)
    nameless = replace(nameless)  # nothing of it is kept
    object.__setattr__(nameless, "unbounded", (unbounded,))
    text, kind = said(trajectory_blocks(nameless))[1]
    assert text.startswith("The robot cannot run it: at 0.1235 s its torques have no bound")
    verdict, level = said([reference_note(nameless)])[0]
    assert ("fails at 0.1235 s: torques have no bound" in verdict, level) == (True, "bad")
    assert trajectory_facts(nameless)[-1].kind == "bad"
    data = trajectory_data(nameless)["failure"]
    assert (data["t_s"], data["limit"], data["leg"]) == (0.123456, "singular", None)
    assert compared_data(nameless)["failure"] == data
    assert "t_sᵀ F = 0.123 N·m instead" in text
    assert kind == "bad"


def test_crossings_have_their_torques_in_the_limit_or_no_bound(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(trajectory, "escape_inertia", lambda design, pose: 0.123456)
    items = [
        SimpleNamespace(
            locus=SimpleNamespace(label=name), t=t, residual=0.0123456,
            torque=(1.5, 2.5, -3.5, 450.0),
        )
        for name, t in (("circle", 0.123456), ("turn", 1.5))
    ]  # fmt: skip
    analysis: Any = SimpleNamespace(
        crossings=items, unbounded=items[1:], design=APPENDIX_4,
        trajectory=SimpleNamespace(at=lambda t: SimpleNamespace(pose=POSE)),
    )  # fmt: skip
    assert cells(crossings_table(analysis)) == [
        ("circle", "0.1235 s", "0.0123 N·m", "1.5 N·m", "2.5 N·m", "−3.5 N·m", "450 N",
         "0.123 kg·m²"),
        ("turn", "1.5 s", "0.0123 N·m", *["no bound"] * 4, "0.123 kg·m²"),
    ]  # fmt: skip


def test_passages_of_a_plan_have_their_speeds_and_drifts(monkeypatch: pytest.MonkeyPatch) -> None:
    item = SimpleNamespace(
        crossing=SimpleNamespace(s=0.56789, locus=SimpleNamespace(label="circle")),
        speed=1.2345, speed_range=(0.5, 2.0), residual=2.34e-14,
    )  # fmt: skip
    plan: Any = SimpleNamespace(
        crossings=(item, item), durations=(0.37234, 10.987), plan=SimpleNamespace(duration=0.5)
    )
    drifts = (
        CrossingDrift(0.2, 1.0, 0.01234, (3e-6, 4e-6, 1e-5, 9.0)),
        CrossingDrift(0.2, 1.0, 0.01234, (3e-9, 4e-9, -1e-8, 9.0)),
    )
    monkeypatch.setattr(trajectory, "payload_drift", lambda design, plan, error: drifts)
    monkeypatch.setattr(trajectory, "unplanned_torque", lambda item, duration: 1000 * duration)
    found = passages_blocks(APPENDIX_4, plan)
    row = ("circle", "0.5679", "1.23 1/s", "0.5 1/s", "2 1/s", "2·10⁻¹⁴ N·m", "500 N·m")
    assert cells(found[1]) == [row] * 2
    assert isinstance(found[1], Table)
    assert "Generalized force along t_s" in found[1].head  # which is in N·m
    assert said(found) == [
        ("Within the limits 0.3724 s to 10.98 s are possible.", "plain"),
        ("circle: 0.1 kg more payload lets the platform drift by 5 µm and 2.1″ in 12 ms.", "warn"),
        (
            "circle: 0.1 kg more payload lets the platform drift by less than 0.01 µm and less "
            "than 0.036″ in 12 ms.", "warn",
        ),
    ]  # fmt: skip
    for shift, text in (
        ((0.95e-8, 0.0, 1.7e-7, 1.0), "less than 0.01 µm and less than 0.036″"),
        ((0.0, 1.05e-8, -1.8e-7, 1.0), "0.01 µm and 0.037″"),
    ):
        assert f" by {text} in" in trajectory._drift_text(CrossingDrift(0.2, 1.0, 0.01, shift))
    plan.crossings, drifts = (), ()
    assert len(passages_blocks(APPENDIX_4, plan)) == 1


def test_numbers_that_a_report_opens_with() -> None:
    """The largest torque of M1 to M3 and force of M4, by their sizes."""
    peaks = [SimpleNamespace(peak=peak) for peak in (1.5, -7.12345, 2.5, -456.789)]
    analysis: Any = SimpleNamespace(summary=peaks, failure=None)
    facts = trajectory.trajectory_facts(analysis)
    assert [fact.value for fact in facts] == ["7.12 N·m", "456.8 N"]
    analysis.summary, analysis.failure = (), "why"
    *rest, failed = trajectory.trajectory_facts(analysis)
    assert [fact.value for fact in rest] == [NONE, NONE]
    assert (failed.value, failed.kind) == ("fails", "bad")
    loaded = APPENDIX_4.vary({"payload.mass": 2.0})
    mass, imbalance = mass_facts(loaded)
    assert mass.value == f"{whole_mass(loaded):.4g} kg"
    assert imbalance.value == f"{static_imbalance(loaded):.3g} N".replace("-", "−")
    rounded = 0.28 + 3 * 9.10041 / 9.81 + 4e-15  # the m_7 that balances
    balanced = APPENDIX_4.vary({"joints.j7": rounded})
    assert static_imbalance(balanced) != 0.0
    assert mass_facts(balanced)[1].value == "0 N"
    assert "Mₚ₂\N{NO-BREAK SPACE}=\N{NO-BREAK SPACE}0" in caption.robot(balanced)


def test_computed_torques_beside_a_published_table() -> None:
    torque = np.array([[1.0, 2.0, np.nan, 4.0], [3.0, -6.0, np.nan, np.nan]])
    off = np.array([[0.1, -0.5, np.nan, 3.0], [-0.3, 0.2, np.nan, np.nan]])
    table: Any = SimpleNamespace(name="other", torque=torque, differences=lambda t, tau: off)
    motion: Any = SimpleNamespace(trajectory=SimpleNamespace(t=None), torque=None)
    first, second, third, fourth = published_differences(motion, table)
    assert third is None
    assert first == {
        "rows": 2, "largest_difference": 0.3, "largest_published": 3.0,
        "rms_difference": pytest.approx(math.sqrt(0.05)),
    }  # fmt: skip
    assert second is not None
    assert (second["largest_difference"], second["largest_published"]) == (0.5, 6.0)
    assert fourth is not None
    assert (fourth["rows"], fourth["largest_difference"]) == (1, 3.0)
    notes = said(published_notes(motion, table))
    assert notes[2] == ("published other, M3: no value at a time of this motion", "warn")
    assert notes[1][0] == (
        "published other, M2: computed off by at most 0.5 N·m, RMS 0.381 N·m, of 6 N·m at 2 times"
    )
    assert notes[3][0].endswith("of 4 N at 1 time")


def test_a_simulated_robot_off_its_motion() -> None:
    error = np.array([[0.001, -0.002, 0.01, 0.0], [-0.003, 0.001, -0.02, 0.0005], [0.0] * 4])
    run: Any = SimpleNamespace(
        error=error, distance=np.array([0.003, 0.004, 0.002]), stopped=None,
        t=np.array([0.0, 1.0, 1.5]), energy_drift=np.array([-2e-6, 1e-6]),
        controller=SimpleNamespace(control=SimpleNamespace(value="torques"), bandwidth=10.0),
        design=APPENDIX_4.vary({"payload.mass": 1.5}),
    )  # fmt: skip
    notes = said(simulation_notes(run))
    assert notes[0] == (
        "simulated with torques, payload 1.5 kg: largest errors x 3 mm, y 2 mm, θ 1.15°, z 0.5 mm; "
        "at the end 2 mm from its place", "plain",
    )  # fmt: skip
    assert notes[1] == ("energy drift of the solution: 2·10⁻⁶ J", "plain")
    data = simulation_data(run)
    assert (data["end_t_s"], data["largest_distance_m"], data["end_distance_m"]) == (
        1.5,
        0.004,
        0.002,
    )
    assert data["largest_error"] == pytest.approx([0.003, 0.002, 0.02, 0.0005])
    assert data["energy_drift_J"] == 2e-6
    assert data["stopped"] is None
    run.stopped = PathEvent(0.75, Limit.SINGULAR, -1, 0.0, POSE)
    assert said(simulation_notes(run))[1][1] == "bad"
    assert simulation_data(run)["stopped"]["t_s"] == 0.75
