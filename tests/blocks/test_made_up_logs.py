"""Tables of logs and of calibrations whose results are made up.

No two numbers are alike, so that each cell can be told from all others.
"""

from __future__ import annotations

import math
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from paminsa_viz.blocks import identification
from paminsa_viz.blocks.calibration import (
    calibration_blocks,
    calibration_data,
    combinations_table,
    deviation_blocks,
    errors_table,
    fitted_text,
    plan_blocks,
    poses_table,
    verdict,
)
from paminsa_viz.blocks.kinds import Figure, Table
from paminsa_viz.model.accuracy import LEG_NAMES
from paminsa_viz.model.design import APPENDIX_4, PARAMETER
from paminsa_viz.model.drive import ACTUATORS
from paminsa_viz.precision.leg_lengths import LENGTHS
from tests.blocks.said import cells, said

# ---------------------------------------------------------------------------------------- a log


def estimate(**changes: Any) -> Any:
    parameter = SimpleNamespace(unit="m", label="a length", design=0.3)
    values = {"parameter": parameter, "symbol": "l", "known": True, "value": 0.301,
              "half_width": 0.002, "reason": lambda: "why"}  # fmt: skip
    return SimpleNamespace(**values | changes)


def test_estimates_are_marked_where_the_design_is_outside_their_interval() -> None:
    items = [
        estimate(), estimate(value=0.303), estimate(value=0.297), estimate(value=0.3015),
        estimate(known=False),
    ]  # fmt: skip
    one = SimpleNamespace(estimates=items, design=APPENDIX_4)
    findings: Any = SimpleNamespace(identification=one)
    table = identification.estimates_table(findings)
    assert [row.kind for row in table.rows] == ["plain", "marked", "marked", "plain", "muted"]
    assert table.words == 2
    finer = SimpleNamespace(unit="m", label="a length", design=0.3001234)
    item = estimate(parameter=finer)
    one.estimates = [item]
    assert cells(identification.estimates_table(findings))[0][3] == "300.1"
    balanced = APPENDIX_4.vary({"joints.j7": 0.28 + 3 * 9.10041 / 9.81 + 4e-15})
    rounding = SimpleNamespace(unit="N", label="imbalance", design=-1.3e-15)
    one.design, one.estimates = balanced, [estimate(symbol="M_p2", parameter=rounding)]
    assert cells(identification.estimates_table(findings))[0][3] == "0"
    assert table.rows[0].cells == ("l [mm]", "a length", "301.0 ± 2.0", "300.0")
    assert table.rows[4].cells[2] == "unknown"
    assert table.rows[0].hint == "why"


def cause(text: str, named: bool, explains: float, unit: str = "m") -> Any:
    return SimpleNamespace(
        text=text, named=named, explains=explains, unit=unit, value=0.002, half_width=0.0001
    )


def test_named_causes_come_before_others_that_explain_something() -> None:
    named = cause("n", True, 0.5)
    others = [cause(f"o{i}", False, 0.1 - 0.01 * i) for i in range(8)]
    none = cause("z", False, 0.0)
    causes = SimpleNamespace(named=[named], ranked=[named, none, *others], unseen=["a", "b"])
    findings: Any = SimpleNamespace(causes=causes)
    table = identification.causes_table(findings)
    assert [row.cells[0] for row in table.rows] == ["n", *(f"o{i}" for i in range(5))]
    assert table.rows[0].cells[1:] == ("2.00 ± 0.10 mm", "50.0 %", "yes")
    assert table.rows[1].cells[2:] == ("10.0 %", "no")
    assert [row.kind for row in table.rows[:2]] == ["marked", "muted"]
    assert identification.cause_size(cause("s", False, 0.1, "")) == "0.200 ± 0.010 %"
    assert identification.unseen_note(findings).text.endswith("log: a; b.")


@pytest.mark.parametrize(("holds", "kind"), [(True, "ok"), (False, "bad"), (None, "plain")])
def test_the_identity_of_the_masses_and_the_verdict(holds: bool | None, kind: str) -> None:
    identity: Any = SimpleNamespace(holds=holds, value=0.5, half_width=0.25, z=3.9)
    note = identification.identity_note(identity)
    assert note.kind == kind
    if holds is not None:
        word = "holds" if holds else "fails"
        assert note.text == f"Identity of the masses: {word}, 0.50 ± 0.25 N, z = 3.9."
    two = (cause("a", True, 0.5), cause("b", True, 0.1))
    for named, problem in (((), ""), (two, ""), ((), "c"), (two, "c")):
        findings: Any = SimpleNamespace(
            identification=SimpleNamespace(identity=identity, problem=problem),
            causes=SimpleNamespace(named=named),
        )
        verdict = identification._verdict(findings)
        told = "; ".join([*(item.text for item in named), *problem])
        assert verdict.kind == ("bad" if told or holds is False else "ok")
        assert (f"may be wrong: {told}." in verdict.text) == bool(told)
        assert ("A spring may be" in verdict.text) == (not told and holds is False)
        assert verdict.text.endswith(note.text)


def test_masses_that_a_log_tells_and_those_that_keep_their_design() -> None:
    parameter = PARAMETER["links.b1"]
    items = [
        SimpleNamespace(
            parameter=parameter, value=1.2500123, told=told, prior=1.2000123, deviation=0.05
        )
        for told in (True, False)
    ]
    findings: Any = SimpleNamespace(nearest=SimpleNamespace(masses=items))
    table = identification.masses_table(findings)
    assert [row.cells[2:] for row in table.rows] == [
        ("1.250 ± 0.050", "1.200", ""), ("1.250", "1.200", "as designed: not in the log"),
    ]  # fmt: skip
    assert [row.kind for row in table.rows] == ["plain", "muted"]
    assert table.words == 2


def test_a_log_as_blocks_and_as_data(monkeypatch: pytest.MonkeyPatch) -> None:
    log = SimpleNamespace(name="one", t=np.zeros(7), rate=250.0, duration=1.5)
    one = estimate(parameter=SimpleNamespace(unit="m", label="a length", design=0.3))
    lost = estimate(symbol="m", known=False)
    identity = SimpleNamespace(holds=True, value=0.5, half_width=0.25, z=3.9)
    named = SimpleNamespace(**vars(cause("n", True, 0.5)), label="N", alike=("o",), p_value=0.001,
                            detectable=0.01)  # fmt: skip
    mass = SimpleNamespace(
        parameter=PARAMETER["links.b1"], value=1.25, told=True, prior=1.2, deviation=0.05
    )
    findings: Any = SimpleNamespace(
        identification=SimpleNamespace(
            log=log, notes=("first", "second"), estimates=[one, lost], identity=identity,
            noise=np.array([0.1, 0.2, 0.3, 45.678]), unknown=[lost], design=APPENDIX_4, problem="",
        ),
        causes=SimpleNamespace(named=[named], ranked=[named], unseen=["a"]),
        nearest=SimpleNamespace(masses=[mass], misfit=1.5), validation=None, payload=None,
    )  # fmt: skip
    blocks = identification.identification_blocks(findings)
    notes = [text for text, _ in said(blocks)]
    assert notes[0] == "Log “one”: 7 rows at 250 Hz, 1.5 s. first; second."
    assert notes[2] == (
        "RMS of what is left: M1 0.1 N·m, M2 0.2 N·m, M3 0.3 N·m, M4 45.7 N."
    )  # fmt: skip
    captions = [block.caption[:7] for block in blocks if isinstance(block, Table)]
    assert captions == ["Numbers", "Unknown", "Causes,", "Masses "]
    unknown = next(block for block in blocks if getattr(block, "caption", "")[:7] == "Unknown")
    assert (cells(unknown), unknown.words) == ([("m", "why")], 2)  # type: ignore
    drawn: list[Any] = []
    plots = "paminsa_viz.plots"
    monkeypatch.setattr(f"{plots}.identification_series.log_series", lambda found: "series")
    monkeypatch.setattr(
        f"{plots}.series_figure.render_series", lambda *a, **k: drawn.append((a, k)) or b""
    )
    (figure,) = (block for block in blocks if isinstance(block, Figure))
    figure.draw()
    assert drawn == [(("series", "svg"), {"caption": False})]
    data = identification.identification_data(findings, [])
    assert data["log"] == {"rows": 7, "name": "one", "rate_Hz": 250.0, "duration_s": 1.5}
    assert data["parameters"][0] == {
        "symbol": "l", "value": 0.301, "half_width_95": 0.002, "known": True, "reason": "why",
        "label": "a length", "unit": "m", "design": 0.3,
    }  # fmt: skip
    assert data["masses"] == [
        {"path": "links.b1", "unit": "kg", "design": 1.2, "nearest": 1.25,
         "deviation_given_the_design": 0.05, "known": True},
    ]  # fmt: skip
    assert data["causes"] == data["named"] == [
        {"cause": "N", "nearly_as_much": ("o",), "unit": "m", "value": 0.002,
         "half_width_95": 0.0001, "p_value": 0.001, "explains": 0.5, "detectable": 0.01},
    ]  # fmt: skip
    assert (data["validation"], data["payload"]) == (None, None)
    findings.validation = SimpleNamespace(
        log=SimpleNamespace(name="two"), residual=1, own=2, ratio=np.ones(4)
    )
    findings.payload = SimpleNamespace(
        mass=2.0, half_width=0.1, free_mass=2.5, free_half_width=0.2, drift=3.0, known=2.1,
        drift_half_width=0.3, gain=None,
    )  # fmt: skip
    data = identification.identification_data(findings, [])
    assert data["validation"]["log"] == "two"
    assert (data["validation"]["residual_rms"], data["validation"]["own_rms"]) == (1, 2)
    assert data["payload"] == {
        "mass_kg": 2.0, "half_width_kg": 0.1, "known_kg": 2.1, "gain": None,
        "with_drift_of_F4": {
            "mass_kg": 2.5, "half_width_kg": 0.2, "drift_N": 3.0, "drift_half_width_N": 0.3,
        },
    }  # fmt: skip
    assert len(identification.identification_blocks(findings)) == len(blocks) + 1
    findings.payload.gain = (0.98, 0.01)
    gain = identification.identification_data(findings, [])["payload"]["gain"]
    assert gain == {"value": 0.98, "half_width": 0.01}


def test_checks_by_other_logs() -> None:
    check = SimpleNamespace(log=SimpleNamespace(name="two"), ratio=np.array([1.0, 1.1, 1.2, 1.3]))
    payload = SimpleNamespace(
        mass=2.0, half_width=0.1, free_mass=2.5, free_half_width=0.2, drift=3.0,
        drift_half_width=0.3, gain=None,
    )  # fmt: skip

    def rows(**changes: Any) -> list[tuple[str, ...]]:
        found: Any = SimpleNamespace(**{"validation": None, "payload": None} | changes)
        return cells(identification.checks_table(found))

    assert rows() == []
    ratios = ", ".join(f"{name} {r:.3g}" for name, r in zip(ACTUATORS, check.ratio, strict=True))
    assert rows(validation=check) == [
        ("Second log, “two”", f"residual over its own fit’s: {ratios}")
    ]
    found = rows(payload=payload)
    assert found == [
        ("Payload", "2.00 ± 0.10 kg"),
        ("if F_4 drifted between the logs", "2.50 ± 0.20 kg, a drift of 3.00 ± 0.30 N"),
    ]
    empty: Any = SimpleNamespace(validation=None, payload=None)
    assert identification.checks_table(empty).words == 2
    payload.gain = (0.98, 0.01)
    assert rows(payload=payload)[2] == ("Common gain of the torques", "0.980 ± 0.010")
    for gain, doubted in ((0.001, True), (0.04, False), (25.0, False), (1e3, True)):
        payload.gain = (gain, 0.01 * gain)  # a mass in grams, or a log without the payload
        assert rows(payload=payload)[2][1].endswith("mass [kg] and which log it is in") == doubted


# ------------------------------------------------------------------------------------- calibration


def errors(poses: int, size: float, coordinates: int = 6) -> Any:
    values = size * (1.0 + np.arange(coordinates))
    return SimpleNamespace(poses=poses, rms=values, largest=3.0 * values)


def calibrated(held: int, **changes: Any) -> Any:
    weights = np.zeros((3, len(LENGTHS)))
    weights[1, 2] = 1.0
    combinations = [
        SimpleNamespace(weights=weights, value=1e-3 * n, half_width=1e-4, singular_value=2.0)
        for n in range(1, 14)
    ]
    spread = np.full((3, len(LENGTHS)), np.nan)
    spread[0, 0] = 2e-4
    values = {
        "before": errors(20, 1e-3), "after": errors(20, 1e-5), "before_held": errors(held, 2e-3),
        "after_held": errors(held, 2e-5), "improved": True, "combinations": combinations,
        "noise": 1.5e-5, "design": APPENDIX_4, "standard_deviations": spread, "start": APPENDIX_4,
        "determined": np.isfinite(spread), "rank": 13, "singular_values": np.arange(42, 0, -1.0),
    }  # fmt: skip
    return SimpleNamespace(**values | changes)


def test_errors_of_a_calibration_before_and_after() -> None:
    table = errors_table(calibrated(5))
    assert table.head[1:] == tuple(
        f"{name}: {kind}"
        for name in ("fitted", "held back") for kind in ("before", "after", "largest")
    )  # fmt: skip
    assert table.rows[0].cells == ("x [µm]", "1000", "10.0", "30.0", "2000", "20.0", "60.0")
    # lengths first, then angles
    assert [row.cells[0][0] for row in table.rows] == ["x", "y", "z", "θ", "t", "t"]
    assert table.rows[2].cells[1] == "4000"
    for count, rest in ((5, ", 5 held back"), (0, "")):
        note, *_ = calibration_blocks(calibrated(count))
        assert said([note])[0][0] == f"20 poses of 6 coordinates fitted{rest}."
    known = {"singular_values": np.array([9.0, 5.0, 3.0, 2.0])}
    ends = {2: "singular values 9 to 5, then 3.", 3: "9 to 3, then 2.", 4: "9 to 2."}
    for rank, text in ends.items():
        said_of = calibration_blocks(calibrated(0, rank=rank, **known))[3].text  # type: ignore
        assert f"{rank} of 42 combinations" in said_of
        assert text in said_of
    assert len(errors_table(calibrated(0)).head) == 4
    four = calibrated(0, before=errors(9, 1e-3, 4), after=errors(9, 1e-5, 4))
    assert len(errors_table(four).rows) == 4
    kinds = {
        (0, True): "warn", (5, True): "ok", (0, False): "bad", (5, False): "bad",
    }  # fmt: skip
    for (held, improved), kind in kinds.items():
        assert verdict(calibrated(held, improved=improved)).kind == kind
    data = calibration_data(calibrated(5), "log")
    assert data["held_back"]["after"]["rms"]["y_m"] == pytest.approx(4e-5)
    assert data["fitted"]["before"]["largest"]["x_m"] == pytest.approx(3e-3)
    assert data["held_back"]["before"]["poses"] == 5
    name = f"{LEG_NAMES[1]}.{LENGTHS[2].name}_{LENGTHS[2].unit}"
    assert data["combinations"][0]["weights"] == {name: 1.0}
    some = calibrated(5)
    some.combinations[0].weights[0, :4] = (1e-6, -0.5, 1.05e-6, -1e-6)
    weights = list(calibration_data(some, "log")["combinations"][0]["weights"].values())
    assert weights == [-0.5, 1.05e-6, 1.0]


def test_combinations_best_and_worst_known_ones() -> None:
    found = calibrated(0)
    assert [row[0] for row in cells(combinations_table(found))] == [str(n) for n in range(1, 14)]
    some = cells(combinations_table(found, 4))
    assert [row[0] for row in some] == ["1", "2", "12", "13"]
    assert some[3][2] == "13.00 ± 0.10"
    assert len(cells(combinations_table(found, 13))) == 13
    assert combinations_table(found).words == 2
    shown = calibration_blocks(found)[4]
    assert [row[0] for row in cells(shown)] == [str(n) for n in (*range(1, 6), *range(9, 14))]
    text = fitted_text(found)
    assert text.startswith("13 of 42 combinations")
    assert "29 keep their value; noise 15 µm" in text
    assert fitted_text(calibrated(0, combinations=found.combinations[:1])).startswith(
        "1 of 42 combinations of lengths is known to 1 mm and fitted, 41 keep"
    )
    all_but_one = calibrated(0, combinations=found.combinations[:1] * 41, rank=1)
    assert "1 keeps its value" in fitted_text(all_but_one)
    assert any(
        text.startswith("1 of 42 combinations shows with equal legs")
        for text, _ in said(calibration_blocks(all_but_one))
    )


def test_deviations_with_an_interval_or_in_sums() -> None:
    table, note = deviation_blocks(calibrated(0))
    assert table.rows[0].cells[2] == "0.00 ± 0.20"  # type: ignore
    assert table.words == 2  # type: ignore
    longer = calibrated(0, design=APPENDIX_4.vary({"leg2.bar_94": 1.23456e-4}))
    (shown,) = (
        row for row in deviation_blocks(longer)[0].rows  # type: ignore
        if any(cell.startswith("0.1") for cell in row.cells[2:])
    )  # fmt: skip
    assert shown.cells[3] == "0.12"
    assert [cell.kind for cell in table.rows[0].cells[2:]] == ["plain", "muted", "muted"]  # type: ignore
    assert "Without ±" in note.text  # type: ignore
    known = np.full((3, len(LENGTHS)), 1e-4)
    whole = calibrated(0, standard_deviations=known, determined=np.isfinite(known))
    assert "Without ±" not in deviation_blocks(whole)[1].text  # type: ignore
    plan: Any = SimpleNamespace(standard_deviations=calibrated(0).standard_deviations)
    table, _ = plan_blocks(plan)
    assert tuple(table.rows[0].cells[2:]) == ("± 0.20", "in sums", "in sums")  # type: ignore


def test_poses_to_measure_in_millimeters_and_degrees() -> None:
    poses = np.array([[0.01, 0.02, math.pi / 6, -0.5, 0.0, 0.0]])
    readings = np.array([[math.pi, 0.5 * math.pi, 0.0, -0.25]])
    plan: Any = SimpleNamespace(measurements=SimpleNamespace(poses=poses, actuators=readings))
    assert cells(poses_table(plan)) == [
        ("1", "10.0", "20.0", "30.00", "−500.0", "180.00", "90.00", "0.00", "−250.0")
    ]
    assert poses_table(plan).literal
