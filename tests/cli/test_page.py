"""``page``: the explorer in one file, of a design or of a share code."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest

from paminsa_viz.explorer.core import persistence
from paminsa_viz.explorer.core.persistence import share_code
from paminsa_viz.explorer.state.document import Document
from paminsa_viz.files.design_file import save_design
from paminsa_viz.model import APPENDIX_4, Counterweight, Design
from paminsa_viz.quantities.requirements import Requirement, Requirements
from tests.support.commands import check_refused, run

LIGHT = APPENDIX_4.vary({"links.b3": 0.2})
CODE = share_code(Document(design=LIGHT, pose=(0.01, 0.02, 0.3, -0.5)))


def opened_with(path: str) -> Document:
    """Return the document that a written page opens with."""
    found = re.search(r"^const PAGE = (.*);$", Path(path).read_text(encoding="utf-8"), re.M)
    assert found is not None
    return persistence.load(json.loads(found[1])["document"])


@pytest.mark.slow
def test_design_and_code_are_written(capsys) -> None:
    needed = Requirements((Requirement("condition", high=8.0),), (-0.3, 0.3))
    save_design(LIGHT, "light.toml", requirements=needed)
    assert run("page", capsys, "--out", "a.html", "--design", "light.toml") == (
        0, "a.html: written\n", "",
    )  # fmt: skip
    opened = opened_with("a.html")
    assert (opened.design, opened.requirements) == (LIGHT, needed)
    crooked = LIGHT.vary({"leg2.bar_94": 1e-4})
    save_design(crooked, "crooked.toml")
    for words in (("--design", "crooked.toml"), ("--code", share_code(Document(crooked)))):
        _, out, _ = run("page", capsys, "--out", "c.html", *words)
        assert out.splitlines()[1:] == [
            "legs are equal, the design's deviations of single legs are left out"
        ]
    assert run("page", capsys, "--out", "b.html", "--code", CODE)[0] == 0
    assert opened_with("b.html") == Document(design=LIGHT, pose=(0.01, 0.02, 0.3, -0.5))


@pytest.mark.parametrize(
    ("words", "place"),
    [
        (("--code", "PMZ2-abc"), "another version"),
        (("--code", CODE[:-9]), "share code: it is damaged or incomplete"),
        (("--code", CODE, "--knee", "upper"), "--code holds a whole design"),
        (("--design", "heavy.toml"), "counterweights"),
        (("--design", "asking.toml"), "at most 24 are possible"),
    ],
)
def test_what_cannot_be_a_page_is_refused(words: tuple[str, ...], place: str, capsys) -> None:
    save_design(Design(counterweights=(Counterweight("b4", 9, 0.1, 1.0),)), "heavy.toml")
    asked = Requirements((Requirement("condition", high=8.0),) * 25)
    save_design(APPENDIX_4, "asking.toml", requirements=asked)
    check_refused("page", capsys, "--out", "x.html", *words, place=place)
    assert not Path("x.html").exists()
