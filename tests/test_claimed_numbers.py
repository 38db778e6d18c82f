"""Precise numbers of the documentation come from somewhere that is run, or are said to be given.

A block of a page that has a number of three digits or more, or a time of milliseconds or less, is
followed by a comment that says where it is from, unless a claim of `verify --report` states it:

    <!-- given: 552 1.75 -->                       an input, a standard, a reference
    <!-- printed by: paminsa-viz loads -->         a command or an example, run here
    <!-- held by: tests/synthesis/test_search.py -->  a test that has the number in it
    <!-- measured by: benchmarks.volume_error -->  a benchmark
    <!-- searched by: paminsa-viz synthesize cell -->  a search that takes minutes
"""

from __future__ import annotations

import io
import re
import runpy
import shlex
from collections.abc import Iterator
from contextlib import redirect_stdout
from functools import cache
from importlib.util import find_spec
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest

from paminsa_viz.cli import command_module, main
from paminsa_viz.cli.arguments import parse
from paminsa_viz.report.claims import CLAIMS

ROOT = Path(__file__).parent.parent
GENERATED = ("command-line", "design-file", "python-api", "speed")
PAGES = [p for p in sorted((ROOT / "docs").glob("*.md")) if p.stem not in GENERATED]
PAGES.append(ROOT / "README.md")
NUMBER = re.compile(r"(?<![\w.,])\d+(?:,\d{3})*(?:\.\d+)?(?!\w|[.,]\d)")
MARK = re.compile(r"<!-- (given|printed by|held by|measured by|searched by): (.*?) -->", re.S)
NAMES = re.compile(r"`[^`]*`|\]\([^)]*\)|https?:\S+|arXiv[: ]\S+|DETC\S+|ISO \S+")

STATED = {float(one) for claim in CLAIMS for one in np.atleast_1d(claim.stated or ()).tolist()}


class Block(NamedTuple):
    """A paragraph, list or table, its precise numbers, and the marks behind it."""

    page: Path
    text: str
    numbers: tuple[str, ...]
    marks: tuple[tuple[str, str], ...]

    def of(self, kind: str) -> list[str]:
        return [what for name, what in self.marks if name == kind]

    @property
    def unstated(self) -> list[str]:
        """Numbers that no claim, input, or test accounts for."""
        given = {word for what in self.of("given") for word in what.split()}
        held = " ".join((ROOT / what).read_text(encoding="utf-8") for what in self.of("held by"))
        known = given | set(NUMBER.findall(held))
        return [one for one in self.numbers if one not in known and value(one) not in STATED]


def value(number: str) -> float:
    return float(number.replace(",", ""))


def precise(text: str) -> tuple[str, ...]:
    """Return numbers of three digits or more; zeros at the ends of whole ones do not count.

    And times that a program would take, however few their digits.
    """
    text = NAMES.sub("", text)
    found = re.findall(r"(?<![\w.])([\d.]+) [mµn]s\b", text)
    for number in NUMBER.findall(text):
        digits = number.replace(",", "")
        digits = digits.replace(".", "") if "." in digits else digits.rstrip("0")
        year = re.fullmatch(r"(19|20)\d\d", number)
        if len(digits.lstrip("0")) >= 3 and not year:
            found.append(number)
    return tuple(dict.fromkeys(found))


def blocks(page: Path) -> Iterator[Block]:
    text, _, _ = page.read_text(encoding="utf-8").partition("\n## Sources")
    text = re.sub(r"^```.*?^```", "", text, flags=re.M | re.S)
    parts = [part for part in re.split(r"\n\s*\n", text) if part.strip()]
    for place, part in enumerate(parts):
        code = all(line.startswith("    ") for line in part.strip("\n").splitlines())
        behind = parts[place + 1].lstrip() if place + 1 < len(parts) else ""
        if part.lstrip().startswith("<!--") or (code and not behind.startswith("<!--")):
            continue
        marks = MARK.findall(behind) if behind.startswith("<!--") else []
        yield Block(page, part, precise(part), tuple(marks))


BLOCKS = [block for page in PAGES for block in blocks(page) if block.numbers or block.marks]


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_precise_numbers_say_where_they_are_from(page: Path) -> None:
    for block in BLOCKS:
        made = {name for name, _ in block.marks} & {"printed by", "measured by", "searched by"}
        if block.page == page and not made:
            assert not block.unstated, block.text


@pytest.mark.slow
def test_marks_name_what_there_is() -> None:
    for block in BLOCKS:
        assert set(" ".join(block.of("given")).split()) <= set(block.numbers), block.text
        for what in block.of("held by"):
            assert set(block.numbers) & set(NUMBER.findall((ROOT / what).read_text())), block.text
        for what in block.of("measured by"):
            assert find_spec(what) is not None, what
        for what in block.of("searched by"):
            name, *words = shlex.split(what)[1:]
            assert parse(command_module(name).FLAGS, words, name, "")


PRINTED = [block for block in BLOCKS if block.of("printed by")]


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Where the lines write their files."""
    return tmp_path_factory.mktemp("printed")


@cache
def printed_by(line: str) -> str:
    """Return what a command or an example prints; several blocks may name it."""
    words = shlex.split(line)
    with redirect_stdout(io.StringIO()) as out:
        if words[0] == "paminsa-viz":
            main(words[1:])
        else:
            runpy.run_path(str(ROOT / line))
    return out.getvalue()


@pytest.mark.slow
@pytest.mark.parametrize("block", PRINTED, ids=lambda one: f"{one.page.stem}:{one.numbers[0]}")
def test_numbers_are_printed_by_what_is_named(
    block: Block, folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(folder)
    texts = [printed_by(line) for line in " ".join(block.of("printed by")).split("; ")]
    printed = np.array([value(one) for one in NUMBER.findall("".join(texts))])
    for number in block.unstated:
        _, _, decimals = number.partition(".")
        whole = len(number) - len(number.rstrip("0")) if "." not in number else -len(decimals)
        assert np.abs(printed - value(number)).min() <= 0.5001 * 10.0**whole, number


def test_a_number_from_nowhere_is_found(tmp_path: Path) -> None:
    page = tmp_path / "page.md"
    page.write_text("It is 12.3 mm, of 200 mm in 2005.\n\n<!-- given: 12.3 -->\n\nNow 4.567 N.\n")
    one, two = blocks(page)
    assert (one.numbers, one.unstated, two.unstated) == (("12.3",), [], ["4.567"])
