"""The report: complete, self-contained, with the model's numbers."""

from __future__ import annotations

import math
import re
import sys
from dataclasses import replace
from datetime import UTC, datetime
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from paminsa_viz.actuation.wrench_capability import capability
from paminsa_viz.balancing import balance
from paminsa_viz.blocks.balance import contributions
from paminsa_viz.blocks.kinds import Note, Row, Table
from paminsa_viz.blocks.trajectory import trajectory_data
from paminsa_viz.files.design_file import load_design
from paminsa_viz.model import APPENDIX_4, PARAMETER, Design, UnreachablePose, static_imbalance
from paminsa_viz.model.parameters import Counterweight
from paminsa_viz.report.design_section import design_section
from paminsa_viz.report.page import report_html
from paminsa_viz.report.request import ReportRequest, Section
from paminsa_viz.report.sections import (
    balance_section,
    checked,
    forces_section,
    trajectory_section,
    verification_section,
)
from paminsa_viz.trajectory import (
    MotionLimits,
    Trajectory,
    analyze,
    paper_like,
    preset_center,
    straight_path,
    time_optimal,
)
from paminsa_viz.units import format_value, number
from tests.support.samples import random_design

pytestmark = pytest.mark.slow


HEAVY = replace(
    APPENDIX_4.vary({"links.b4": 0.9, "payload.mass": 2.5}),
    name="Heavier <arm> & more",
    counterweights=(Counterweight("b8", 8, 0.1, 0.75),),
)
WHEN = datetime(2025, 3, 4, 5, 6, tzinfo=UTC)


def request_for(design: Design = HEAVY, **more: Any) -> ReportRequest:
    return ReportRequest(
        design=design,
        pose=tuple(preset_center(design.geometry).tolist()),
        trajectory=paper_like(design.geometry).lasting(0.4).sample(100),
        made=WHEN,
        command="paminsa-viz report --out a_b.html",
        **more,
    )


@pytest.fixture(scope="module")
def report() -> str:
    return report_html(request_for(verified=False))


class Reader(HTMLParser):
    """Checks that tags close, and collects attributes by their name, tags, rows and text."""

    VOID = frozenset({"meta", "img", "link", "br", "hr", "input"})

    def __init__(self, text: str) -> None:
        super().__init__()
        self.open: list[str] = []
        self.attributes: dict[str, list[str]] = {}
        self.tags: set[str] = set()
        self.rows: list[tuple[str, list[str]]] = []
        self.text = ""
        self.feed(text)
        self.close()
        assert not self.open

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.add(tag)
        if tag not in self.VOID:
            self.open.append(tag)
        for key, value in attrs:
            self.attributes.setdefault(key, []).append(value or "")
        if tag == "tr":
            self.rows.append((dict(attrs).get("class") or "", []))
        if tag in ("td", "th"):
            self.rows[-1][1].append("")

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag

    def handle_data(self, data: str) -> None:
        if "style" not in self.open:
            self.text += data
        if {"td", "th"} & {*self.open}:
            self.rows[-1][1][-1] += data


def blocks(section: Section, kind: type[Any]) -> list[Any]:
    return [block for block in section.blocks if isinstance(block, kind)]


def test_report_is_one_self_contained_file(report: str) -> None:
    page = Reader(report)
    assert all(place.startswith("data:image/svg+xml;base64,") for place in page.attributes["src"])
    assert page.attributes.keys().isdisjoint({"srcset", "data"})
    assert page.tags.isdisjoint({"script", "link", "iframe", "object"})
    assert "@import" not in report
    assert "url(" not in report
    ids = page.attributes["id"]
    assert ids == [
        "design", "workspace", "maps", "forces", "stiffness", "accuracy", "trajectory", "loads",
        "clearance", "verification", "balance", "provenance",
    ]  # fmt: skip
    assert {f"#{key}" for key in ids} == set(page.attributes["href"])


def test_values_that_differ_are_marked_next_to_appendix_4(report: str) -> None:
    page = Reader(report)
    marked = [cells for kind, cells in page.rows if kind == "marked"]
    assert ["mB4", "B4, bar 9-4-5", "0.9 kg", "0.672 kg", "+33.9 %"] in marked
    assert ["mload", "payload", "2.5 kg", "0 kg", "new"] in marked
    assert any("B8, 100 mm beyond joint 8" in cells[0] for _, cells in page.rows)
    assert "arm" not in page.tags  # the name's markup is text
    assert "Heavier <arm> & more" in page.text


def test_equal_requests_give_equal_reports_and_the_file_inside_is_the_design(
    report: str, without_pictures: None, tmp_path: Path
) -> None:
    pictures = re.compile('base64,[^"]*')  # that they repeat is tested where they are drawn
    assert report_html(request_for(verified=False)) == pictures.sub("base64,", report)
    page = Reader(report)
    start = page.text.index("# Design of a PAMINSA")
    path = tmp_path / "d.toml"
    path.write_text(page.text[start:], encoding="utf-8")
    assert load_design(path) == HEAVY
    assert "paminsa-viz report --out a_b.html" in page.text
    assert "2025-03-04 05:06 UTC" in page.text


def test_design_of_the_paper_needs_no_column_of_changes() -> None:
    section = design_section(APPENDIX_4)
    (note,), (table,) = blocks(section, Note), blocks(section, Table)
    assert "All values are those" in note.text
    assert len(table.head) == 3
    assert all(row.kind != "marked" for row in table.rows)


def test_every_number_that_differs_is_listed() -> None:
    for path, parameter in PARAMETER.items():
        now = APPENDIX_4.value(path)
        changed = 1e6 if math.isinf(now) else 1.001 * now if now else 1e-4
        section = design_section(APPENDIX_4.vary({path: changed}))
        (note, *_), (table,) = blocks(section, Note), blocks(section, Table)
        marked = [row.cells for row in table.rows if row.kind == "marked"]
        assert f"{len(marked)} value{' differs' if len(marked) == 1 else 's differ'}" in note.text
        assert (parameter.symbol, parameter.label) in [cells[:2] for cells in marked], path
        assert all(cell and "inf" not in cell for cells in marked for cell in cells), path


def test_deviations_of_legs_that_are_listed_are_said_to_be_left_out_elsewhere() -> None:
    section = design_section(APPENDIX_4.vary({"leg2.bar_94": 1e-4}))
    assert [note.text for note in blocks(section, Note)[1:]] == [
        "But for errors of the pose by tolerances and the calibration, legs are equal, the "
        "design’s deviations of single legs are left out."
    ]


@pytest.mark.parametrize("seed", range(5))
def test_bodies_add_up_to_mp2(seed: int) -> None:
    rng = np.random.default_rng(seed)
    weights = (Counterweight("b3", 7, 0.05, 0.3), Counterweight("b4", 9, -0.1, 0.2))
    design = replace(random_design(rng), counterweights=weights)
    parts = [share for _, _, share in contributions(design)]
    assert sum(parts) == pytest.approx(static_imbalance(design), rel=1e-12)
    assert len(parts) == 9


def test_balance_is_shown_unless_the_design_is_balanced() -> None:
    motion = request_for().trajectory
    tables = blocks(balance_section(analyze(APPENDIX_4, motion)), Table)
    assert "+994 %" in tables[1].rows[0].cells
    assert tables[2].rows[0].cells == ("M_p2 [N]", "9.100", "0", "−100 %")
    after = balance(APPENDIX_4).after
    peaks = analyze(after, motion).summary
    assert tables[2].rows[2] == Row(("largest in motion",), "group")
    assert [row.cells[2] for row in tables[2].rows[3:7]] == [
        number(abs(s.peak), padded=True) for s in peaks
    ]
    notes = blocks(balance_section(analyze(after, motion)), Note)
    assert any("is balanced" in note.text for note in notes)


def test_verification_is_reported_or_the_reason_it_is_missing(
    report: str, mujoco: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert "Not requested" in Reader(report).text
    found = checked(request_for())
    assert not isinstance(found, str)
    section = verification_section(found)
    tables = blocks(section, Table)
    assert len(tables) == len(found.engines) + 1
    assert len(tables[-1].rows) == 6
    for shown, kind, verdict in (
        (section, "ok", "Passed: "),
        (verification_section(replace(found, tolerance=1e-20)), "bad", "Failed: "),
    ):
        note = blocks(shown, Note)[0]
        assert (note.kind, note.text[:8]) == (kind, verdict)
    monkeypatch.setitem(sys.modules, "mujoco", None)
    assert "pip install mujoco" in str(checked(request_for()))


@pytest.mark.usefixtures("report_of_the_motion", "without_pictures")
def test_a_motion_that_fails_is_named() -> None:
    near = request_for(APPENDIX_4).trajectory
    sinking = near.pose - np.linspace(0, 0.6, near.size)[:, None] * [0, 0, 0, 1]
    motion = Trajectory(near.t, sinking, near.velocity, near.acceleration)
    section = trajectory_section(analyze(APPENDIX_4, motion))
    (bad,) = (note for note in blocks(section, Note) if note.kind == "bad")
    assert "over-stretched" in bad.text
    text = Reader(report_html(replace(request_for(APPENDIX_4), trajectory=motion))).text
    assert "the robot cannot run it" in text
    assert "Not verified: the trajectory cannot be run" in text


def test_a_pose_out_of_reach_is_refused() -> None:
    with pytest.raises(UnreachablePose):
        report_html(replace(request_for(), pose=(0.0, 0.0, 0.0, -3.0)))


GAPS = """() => [...document.querySelectorAll("h2")].map((heading) => {
  const [number, title] = [...heading.childNodes].map((part) => {
    const range = document.createRange();
    range.selectNodeContents(part);
    return range.getBoundingClientRect();
  });
  return title.left - number.right;
})"""
"""Pixels between the number of each section and its title."""


PAPER = 680
"""Width of the text on A4 paper, 180 mm, in a browser's pixels."""
TABLES = """() => Math.max(...[...document.querySelectorAll('table')].map((table) =>
  table.getBoundingClientRect().right))"""
"""Where the widest table ends."""

BROKEN_WORDS = """() => {
  const range = document.createRange(), found = [];
  const walk = document.createTreeWalker(document.querySelector("main"), NodeFilter.SHOW_TEXT);
  while (walk.nextNode()) {
    const node = walk.currentNode;
    if (!node.parentElement.closest("th, td")) continue;
    for (const word of node.data.matchAll(/\\p{L}+/gu)) {
      range.setStart(node, word.index);
      range.setEnd(node, word.index + word[0].length);
      if (range.getClientRects().length > 1) found.push(word[0]);
    }
  }
  return found;
}"""
"""Words of tables that go on in the next line."""
CAPTIONS = """() => Math.max(...[...document.querySelectorAll("caption span")].map((text) =>
  text.getBoundingClientRect().right))"""
"""Where the widest caption of a table ends."""
NARROWEST = """() => Math.min(...[...document.querySelectorAll("figure:not(.half) img")]
  .map((picture) => picture.clientWidth))"""
"""Width of the smallest figure of a whole line."""
LINES_OF_FACTS = """() => {
  const facts = document.querySelectorAll(".fact");
  if (facts.length === 5) facts[0].after(facts[0].cloneNode(true)); // as when a trajectory fails
  return new Set([...document.querySelectorAll(".fact")].map((fact) => fact.offsetTop)).size;
}"""
"""Lines of the opening's numbers, of six of them."""


@pytest.mark.browser
def test_browser_shows_and_prints_the_report_without_requests(
    report: str, browser: Any, tmp_path: Path
) -> None:
    path = tmp_path / "report.html"
    path.write_text(report, encoding="utf-8")
    page = browser.new_context(viewport={"width": 1280, "height": 900}).new_page()
    asked: list[str] = []
    said: list[str] = []
    page.on("request", lambda request: asked.append(request.url))
    page.on("console", lambda message: said.append(message.text))
    page.goto(path.as_uri())
    broken = page.evaluate(
        "[...document.images].filter(i => !i.complete || !i.naturalWidth).length"
    )
    assert broken == 0
    assert min(page.evaluate(GAPS)) > 6
    for width in (1280, 400):
        page.set_viewport_size({"width": width, "height": 900})
        across = page.evaluate("document.documentElement.scrollWidth")
        assert across <= width
        assert page.evaluate(BROKEN_WORDS) == []
        assert page.evaluate(CAPTIONS) <= width
        assert page.evaluate(NARROWEST) > 500  # pixels, or letters would be too small to read
    printed = page.pdf(prefer_css_page_size=True)
    page.set_viewport_size({"width": PAPER, "height": 900})
    page.emulate_media(media="print")
    assert page.evaluate(TABLES) <= PAPER + 1
    assert page.evaluate(LINES_OF_FACTS) == 1
    page.close()
    assert [url for url in asked if not url.startswith(("file:", "data:"))] == []
    assert said == []
    assert printed.startswith(b"%PDF")
    assert 6 <= printed.count(b"/Type /Page\n") <= 20


def test_forces_are_those_of_the_load_and_the_limits() -> None:
    loaded = HEAVY.vary({"load.force_x": 20.0, "load.moment_y": 3.0})
    blocks = forces_section(request_for(loaded)).blocks
    tables = [block for block in blocks if isinstance(block, Table)]
    texts = [" ".join(row.cells) for table in tables for row in table.rows]
    at = capability(loaded, preset_center(loaded.geometry))
    force = format_value(float(at.horizontal_force), "N")
    assert any(text.startswith("F_h") and force in text for text in texts)
    load, bearings, limit = (block.text for block in blocks if isinstance(block, Note))
    assert "F_x = 20 N, F_y = 0 N" in load
    assert "The bearings alone carry M_x = 0 N·m, M_y = 3 N·m" in bearings
    assert "is limited by M" in limit
    (none, *_) = forces_section(request_for()).blocks
    assert none == Note("No external force or moment acts on the platform.")
    assert "load" not in [row.cells[0] for row in design_section(HEAVY).blocks[1].rows]


def test_planned_crossings_are_listed_and_those_of_another_robot_are_warned_of() -> None:
    path = straight_path([0.1, 0.0, 0.2, -0.5], [0.36, 0.02, 0.5, -0.5])
    lighter = balance(APPENDIX_4).after
    found = time_optimal(lighter, path, MotionLimits(torque=10.0))
    samples = found.plan.sample(1000.0)

    def blocks(design: Design) -> tuple[list[Table], list[Note]]:
        section = trajectory_section(analyze(design, samples))
        tables = [b for b in section.blocks if isinstance(b, Table) and b.head[1] == "At"]
        return tables, [b for b in section.blocks if isinstance(b, Note) and b.kind == "bad"]

    (table,), warnings = blocks(lighter)
    assert not warnings
    cells = table.rows[0].cells
    assert cells[0] == "singular circle"
    assert float(cells[3].split()[0].replace("−", "-")) == pytest.approx(
        found.crossings[0].torque[0], abs=2e-3
    )
    (table,), (warning,) = blocks(APPENDIX_4)
    assert "no bound" in table.rows[0].cells
    assert "have no bound" in warning.text

    (known,), (unknown,) = (
        trajectory_data(analyze(design, samples))["crossings"] for design in (lighter, APPENDIX_4)
    )
    assert known["torques"] == pytest.approx(found.crossings[0].torque, abs=2e-3)
    assert (known["locus"], known["residual_Nm"]) == ("circle", pytest.approx(0.0, abs=1e-6))
    assert known["inertia_kg_m2"] > 0.0
    assert unknown["torques"] is None
    assert abs(unknown["residual_Nm"]) > 0.1
