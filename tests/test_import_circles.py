"""Imports between files form no circle: those for type checkers and late ones count, too."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

import pytest

import paminsa_viz

ROOT = Path(paminsa_viz.__file__).parent
EXPLORER = "paminsa_viz.explorer"


def _name(file: Path) -> str:
    parts = file.relative_to(ROOT.parent).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


def _modules() -> dict[str, Path]:
    return {_name(file): file for file in sorted(ROOT.rglob("*.py"))}


def _statements(tree: ast.AST) -> Iterator[ast.AST]:
    """Yield all statements, nested ones as well; no expression contains an import."""
    for node in ast.iter_child_nodes(tree):
        if isinstance(node, ast.stmt | ast.ExceptHandler | ast.match_case):
            yield node
            yield from _statements(node)


def _imports(file: Path, modules: dict[str, Path]) -> set[str]:
    """Return the modules whose names the file takes, from whatever place in it."""
    names: set[str] = set()
    for node in _statements(ast.parse(file.read_text())):
        if isinstance(node, ast.Import):
            names.update(alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{file}: relative import"
            for alias in node.names:
                full = f"{node.module}.{alias.name}"
                names.add(full if full in modules else str(node.module))
    return names & modules.keys()


@pytest.mark.slow
def test_files_outside_the_explorer_import_each_other_in_one_direction_only():
    modules = _modules()
    graph = {
        name: _imports(file, modules) - {name}
        for name, file in modules.items()
        if not name.startswith(EXPLORER)
    }
    try:
        order = list(TopologicalSorter(graph).static_order())
    except CycleError as error:
        raise AssertionError(" -> ".join(error.args[1])) from None
    assert order.index("paminsa_viz.model.design") < order.index("paminsa_viz.cli")
