"""Texts of page, report and page in one file have one form of apostrophes and of sections' names.

Commands print ``'`` for ’ (`cli.output`), design files have it (`files.design_writer`), and what an
error says is plain in a terminal and a sentence on the page (`units.as_sentence`).
"""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from pathlib import Path

import pytest

import paminsa_viz
from paminsa_viz.files.design_writer import write_design
from paminsa_viz.model import APPENDIX_4, PARAMETER
from paminsa_viz.units import as_sentence

PACKAGE = Path(paminsa_viz.__file__).parent
SHOWN = ("blocks", "explorer", "plots", "quantities", "report")
"""Folders whose texts people read on a page."""

STRAIGHT = re.compile(r"[A-Za-z](?:'[st]\b|s'(?= |[.,;:)]|$))")
QUOTED = re.compile(r"\b(?:section|folder|tab|panel) “")
ALONE = {
    "map_values.py": "a pose (4,) at the field's theta",  # of an error
    "features/one_file/documents.js": "Without a value it is Appendix 4's",  # of a design file
    "browser/self_test.js": "each input's newest value",  # of the browser's console
}
"""Texts that nobody reads on a page."""


def texts_of(path: Path) -> Iterator[str]:
    """Yield the texts that a file of the program shows: no comments, errors or lines of the log."""
    source = path.read_text("utf-8")
    if path.suffix == ".py":
        yield from _texts_of_tree(ast.parse(source))
    elif path.suffix == ".js":
        yield re.sub(r"/\*.*?\*/|(?<!:)//[^\n]*", "", source, flags=re.S)
    else:
        yield re.sub(r"\{#.*?#\}|\{%.*?%\}|\{\{.*?\}\}|<meta[^>]*>", "", source, flags=re.S)


def _texts_of_tree(node: ast.AST) -> Iterator[str]:
    for child in ast.iter_child_nodes(node):
        match child:
            case ast.Raise() | ast.Expr(value=ast.Constant()):
                continue
            case ast.Call(func=ast.Attribute(value=ast.Name(id="log"))):
                continue
            case ast.Call(func=ast.Name(id="InvalidInput" | "FileError")):
                continue
            case ast.Constant(value=str(text)):
                yield text
        yield from _texts_of_tree(child)


@pytest.mark.slow
def test_texts_have_typographic_apostrophes_and_names_of_sections_without_quotes() -> None:
    found, seen = [], 0
    for folder in SHOWN:
        for path in sorted((PACKAGE / folder).rglob("*")):
            if path.suffix not in (".py", ".js", ".j2", ".html") or "server" in path.parts:
                continue
            name = path.relative_to(PACKAGE / folder).as_posix()
            for text in texts_of(path):
                seen += text.count("’")
                rest = text.replace(ALONE.get(name, "\0"), "")
                hits = (*STRAIGHT.finditer(rest), *QUOTED.finditer(rest))
                found += [f"{name}: {rest[: hit.end()][-40:]!r}" for hit in hits]
    assert found == []
    assert seen > 80


def test_names_of_numbers_have_them_too_and_design_files_are_plain() -> None:
    labels = {path: parameter.label for path, parameter in PARAMETER.items()}
    assert [label for label in labels.values() if "'" in label] == []
    own = {path: 1e-3 for path, label in labels.items() if "’" in label}
    text = write_design(APPENDIX_4.vary(own))
    assert text.isascii()
    assert "Young's modulus of the bars" in text


def test_errors_are_sentences_with_typographic_apostrophes() -> None:
    said = as_sentence("a tube's end isn't there: 'x' or 'ts' is needed, not 'a's'")
    assert said == "A tube’s end isn’t there: 'x' or 'ts' is needed, not 'a’s'."
