"""The section on identification: numbers, unknowns, causes, masses; nothing without a log."""

from __future__ import annotations

import numpy as np
import pytest

from paminsa_viz.blocks.kinds import Figure, Note, Table
from paminsa_viz.files.example_logs import ExampleLog, example_log
from paminsa_viz.identification import make_log
from paminsa_viz.identification.findings import investigate
from paminsa_viz.model import APPENDIX_4
from paminsa_viz.report.sections import identification_section
from paminsa_viz.units import unit_text


@pytest.fixture(scope="module")
def findings():
    return investigate(
        example_log(), APPENDIX_4, other=example_log(ExampleLog.OTHER),
        loaded=example_log(ExampleLog.PAYLOAD), payload=2.0,
    )  # fmt: skip


@pytest.mark.slow
def test_section_holds_numbers_figure_causes_and_masses(findings) -> None:
    section = identification_section(findings)
    numbers, why, causes, checks, masses = (b for b in section.blocks if isinstance(b, Table))
    estimates = findings.identification.estimates
    symbols = [row.cells[0].partition(" [")[0] for row in numbers.rows]
    assert symbols == [item.symbol for item in estimates]
    units = [row.cells[0].partition(" [")[2].removesuffix("]") for row in numbers.rows]
    assert units == [unit_text(item.parameter.unit) for item in estimates]
    unknown = [s for s, row in zip(symbols, numbers.rows, strict=True) if row.cells[2] == "unknown"]
    assert unknown == [row.cells[0] for row in why.rows]
    assert unknown == [item.symbol for item in findings.identification.unknown]
    marked = {s for s, row in zip(symbols, numbers.rows, strict=True) if row.kind == "marked"}
    assert "M_p2" in marked
    assert all(row.cells[3] == "no" for row in causes.rows)
    assert len(masses.rows) == len(findings.nearest.masses)
    notes = [b for b in section.blocks if isinstance(b, Note)]
    assert [b.kind for b in notes].count("ok") == 1
    assert any(all(text in b.text for text in findings.causes.unseen) for b in notes)
    assert checks.rows[-1].cells[0].startswith("Common gain")
    figure = next(b for b in section.blocks if isinstance(b, Figure))
    assert b"Measured and predicted torques" in figure.svg


@pytest.mark.slow
def test_wrong_model_stands_out() -> None:
    log = example_log()
    wrong = make_log(log.t, log.position, log.torque * np.array([1.0, 1.1, 1.0, 1.0]))
    section = identification_section(investigate(wrong, APPENDIX_4))
    bad = [b for b in section.blocks if isinstance(b, Note) and b.kind == "bad"]
    assert len(bad) == 1
    assert "M2" in bad[0].text
