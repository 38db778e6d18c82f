"""Requirements and synthesis in the report: verdicts, volume, the proven workspace, the search."""

from __future__ import annotations

import re
from dataclasses import replace
from functools import partial

import pytest
from hypothesis import given
from hypothesis import strategies as st

from paminsa_viz.blocks import requirements as section
from paminsa_viz.blocks import synthesis
from paminsa_viz.blocks.kinds import Note, Table
from paminsa_viz.cli.output import ascii_numbers
from paminsa_viz.model import APPENDIX_4
from paminsa_viz.quantities.requirements import (
    Requirement,
    Requirements,
    Workspace,
    WorkspaceShape,
)
from paminsa_viz.report.sections import synthesis_section
from paminsa_viz.synthesis import Effort, SearchRange, SynthesisCase, synthesize
from paminsa_viz.synthesis.volume.check import Over, RequirementsCheck, check_requirements
from paminsa_viz.synthesis.volume.conflict import Conflict, VolumeRelaxation
from paminsa_viz.synthesis.volume.grid import COARSE
from paminsa_viz.synthesis.volume.solve import solve_volume

NEEDS = Requirements(
    (Requirement("condition", high=10.0), Requirement("f_4", high=200.0)),
    (-0.5, 0.5),
    Workspace(WorkspaceShape.CYLINDER, (0.2, 0.2, 0.1), (0.0, 0.0, -0.55)),
)

pytestmark = pytest.mark.slow


def test_broken_requirements_are_marked_and_the_volume_says_what_they_take(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(section, "TIME_LIMIT", 0.5)
    monkeypatch.setattr(section, "solve_volume", partial(solve_volume, resolution=COARSE))
    found = section.requirements_blocks(APPENDIX_4, NEEDS)
    tables = [block for block in found if isinstance(block, Table)]
    notes = [block.text for block in found if isinstance(block, Note)]
    checked = check_requirements(APPENDIX_4, NEEDS, fine=True)
    marked = [row.cells[0] for row in tables[0].rows if row.kind == "marked"]
    assert marked == [item.label for item in checked.items if not item.holds] == ["F₄ ≤ 200 N"]
    assert "A requirement is broken." in notes
    assert any("dm³" in note or "is empty" in note for note in notes)


def test_a_volume_away_from_home_is_said_to_be_one() -> None:
    solved = solve_volume(APPENDIX_4, Requirements(NEEDS.bounds[:1]), resolution=COARSE)
    for home in (True, False):
        volume = replace(solved, home_inside=home)
        check = RequirementsCheck((), Over.VOLUME, None, volume)
        blocks = section.check_blocks(volume.requirements, check)
        said = any("Home is not in it" in block.text for block in blocks if isinstance(block, Note))
        assert said is not home
        (table,) = [b for b in blocks if isinstance(b, Table) and b.head[0] == "Cause"]
        first = [row.cells[2].removesuffix(" %") for row in table.rows if row.cells[2]]
        inside = {cause.word: share for cause, share in volume.shares().items()}["inside"]
        assert sum(map(float, first)) == pytest.approx(100 * (1 - inside), abs=0.1 * len(first))


@given(st.floats(1.0, 1e4), st.booleans())
def test_relaxed_bounds_are_rounded_to_the_side_that_helps(size: float, most: bool) -> None:
    before, after = (
        Requirement("condition", high=value) if most else Requirement("condition", low=value)
        for value in (size / 2 if most else 2 * size, size)
    )
    relaxation = VolumeRelaxation(0, size / 2, after, None)
    blocks = section.check_blocks(
        Requirements((before,)),
        RequirementsCheck((), Over.BEST, None, None),
        Conflict((0,), (relaxation,)),
    )
    text = blocks[-1].text if isinstance(blocks[-1], Note) else ""
    (shown,) = re.findall(r"at (?:least|most) (\S+) \(", text)
    helps = (float(ascii_numbers(shown)) - size) * (1 if most else -1)
    assert -1e-9 * size <= helps <= 1.1e-3 * size


def test_a_search_is_told_with_what_it_changed(monkeypatch: pytest.MonkeyPatch) -> None:
    """But for whether the robot can be built, which takes longer than all else."""
    monkeypatch.setattr(synthesis, "buildability_blocks", lambda _: [])
    needs = Requirements(NEEDS.bounds[:1], NEEDS.theta, NEEDS.workspace)
    path = "geometry.base_radius"
    case = SynthesisCase(
        needs, (SearchRange(path, 0.3, 0.5),), effort=Effort(3, 4), allow_overlap=True
    )
    result = synthesize(case)
    assert result.feasible
    blocks = synthesis_section(result).blocks
    lengths = next(b for b in blocks if isinstance(b, Table) and b.caption.startswith("Lengths"))
    assert "R_b [mm]" in {row.cells[0] for row in lengths.rows}
    assert any(f"{1e3 * result.objective:.4g} mm" in b.text for b in blocks if isinstance(b, Note))
