"""The Python API is documented and typed: every public name, field and argument."""

from __future__ import annotations

import ast
import importlib
import inspect
import pkgutil
import re
import runpy
import subprocess
import sys
import types
from collections.abc import Iterator
from dataclasses import fields, is_dataclass
from enum import Enum
from functools import cache
from itertools import pairwise
from pathlib import Path
from typing import Any, get_type_hints

import pytest

import paminsa_viz
from paminsa_viz.model.arguments import of_design

ROOT = Path(__file__).parents[1]

PACKAGES = tuple(runpy.run_path(str(ROOT / "docs" / "generate.py"))["API"])
"""The packages of the reference page."""


def public() -> Iterator[tuple[str, Any]]:
    for package in PACKAGES:
        module = importlib.import_module(package)
        for name in module.__all__:
            yield f"{package}.{name}", getattr(module, name)


CALLABLES = {
    name: value for name, value in public() if inspect.isclass(value) or inspect.isroutine(value)
}
"""Public functions and classes by their full names."""


@pytest.mark.parametrize("package", PACKAGES)
def test_package_has_a_docstring_and_unique_names(package) -> None:
    module = importlib.import_module(package)
    assert module.__doc__
    assert len(module.__all__) == len(set(module.__all__))
    assert all(hasattr(module, name) for name in module.__all__)


def test_public_names_have_docstrings() -> None:
    for place, value in CALLABLES.items():
        own = value.__doc__ or ""
        generated = f"{value.__name__}("  # what dataclass writes where there is nothing
        assert own.strip(), place
        assert not own.startswith(generated), place
        if not inspect.isclass(value) or getattr(value, "_is_protocol", False):
            continue
        for name, method in vars(value).items():
            if not name.startswith("_") and isinstance(method, (types.FunctionType, property)):
                assert inspect.getdoc(method), f"{place}.{name}"


def test_public_functions_are_typed() -> None:
    for place, value in CALLABLES.items():
        function = value.__init__ if inspect.isclass(value) else value
        if is_dataclass(value) or (inspect.isclass(value) and issubclass(value, Enum)):
            continue
        if not hasattr(function, "__annotations__"):
            continue
        for name, parameter in inspect.signature(function).parameters.items():
            if name not in ("self", "args", "kwds", "kwargs"):
                assert parameter.annotation is not inspect.Parameter.empty, f"{place}: {name}"


@pytest.mark.slow
def test_every_field_is_documented() -> None:
    """In the class's text, in one of its own below it, or as a design value by its label.

    What a term of an optimization is called is said where terms are, see `Term`.
    """
    for place, value in CALLABLES.items():
        if not (inspect.isclass(value) and is_dataclass(value)):
            continue
        text = inspect.getdoc(value) or ""
        below = _below(value) | ({"label", "unit"} if hasattr(value, "convex_term") else set())
        for item in fields(value):
            if item.name.startswith("_") or "label" in item.metadata or item.name in below:
                continue
            assert re.search(rf"\b{item.name}\b", text), f"{place}.{item.name}"


def test_results_of_arrays_can_be_compared() -> None:
    """Equal is the same one: fields of arrays, compared one by one, would end in NumPy's error."""
    found = 0
    for place, value in CALLABLES.items():
        if inspect.isclass(value) and is_dataclass(value):
            kinds = [str(item.type) for item in fields(value) if item.compare]
            kinds = [kind for kind in kinds if not kind.startswith("Callable")]
            arrays = any(re.search(r"\b(Array|NDArray)\b", kind) for kind in kinds)
            found += arrays
            assert not (arrays and value.__eq__ is not object.__eq__), place
    assert found >= 30


@cache
def _classes(file: str) -> dict[str, ast.ClassDef]:
    """Return the classes that a file defines, by their names."""
    body = ast.parse(Path(file).read_text(encoding="utf-8")).body
    return {node.name: node for node in body if isinstance(node, ast.ClassDef)}


def _below(value: type) -> set[str]:
    """Return the fields of a class that have a text below them."""
    return {
        item.target.id
        for item, after in pairwise(_classes(inspect.getfile(value))[value.__name__].body)
        if isinstance(item, ast.AnnAssign)
        and isinstance(item.target, ast.Name)
        and isinstance(after, ast.Expr)
        and isinstance(after.value, ast.Constant)
    }


@pytest.mark.slow
def test_importing_the_package_does_not_import_numpy() -> None:
    code = "import sys, paminsa_viz; assert 'numpy' not in sys.modules; paminsa_viz.APPENDIX_4"
    subprocess.run([sys.executable, "-c", code], check=True)


SUBPACKAGES = sorted(path.parent for path in (ROOT / "paminsa_viz").glob("*/__init__.py"))


def test_every_room_lists_its_public_names() -> None:
    assert len(SUBPACKAGES) >= 20
    assert {f"paminsa_viz.{subpackage.name}" for subpackage in SUBPACKAGES} <= set(PACKAGES)


def _late_imports(init: Path) -> dict[str, str]:
    """Return what a package imports for type checkers alone, with its modules."""
    return {
        alias.name: str(item.module).removeprefix("paminsa_viz.")
        for block in ast.parse(init.read_text()).body
        if isinstance(block, ast.If)
        for item in block.body
        if isinstance(item, ast.ImportFrom)
        for alias in item.names
    }


LATE = {
    ".".join(init.parent.relative_to(ROOT).parts): found
    for init in sorted((ROOT / "paminsa_viz").rglob("__init__.py"))
    if (found := _late_imports(init))
}
"""Packages whose names are imported on first use, with the names' modules."""


@pytest.mark.parametrize("package", LATE)
def test_names_imported_on_first_use_are_listed_and_no_module_takes_their_place(
    package: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    module, names = importlib.import_module(package), LATE[package]
    assert names.keys() - {"__version__"} <= set(module.__all__)
    assert not names.keys() & {one.name for one in pkgutil.iter_modules(module.__path__)}
    for name, home in names.items():
        assert getattr(module, name) is getattr(
            importlib.import_module(f"paminsa_viz.{home}"), name
        )
    monkeypatch.delattr(module, next(iter(names)))  # as before its first use
    assert set(module.__all__) <= set(dir(module))
    with pytest.raises(AttributeError, match=f"'{package}' has no attribute 'nothing'"):
        module.nothing  # noqa: B018


def test_documentation_and_examples_import_public_names_only() -> None:
    found = 0
    for page in sorted([*ROOT.glob("*.md"), *ROOT.glob("docs/*.md"), *ROOT.glob("examples/*.*")]):
        text = page.read_text(encoding="utf-8")
        blocks = re.findall(r"^```python\n(.*?)^```", text, re.M | re.S)
        for code in [text] if page.suffix == ".py" else blocks:
            for node in ast.walk(ast.parse(code)):
                if isinstance(node, ast.Import):
                    assert not any("paminsa_viz." in alias.name for alias in node.names), page.name
                elif isinstance(node, ast.ImportFrom) and "paminsa_viz" in str(node.module):
                    assert node.module in PACKAGES, f"{page.name} imports from {node.module}"
                    listed = importlib.import_module(node.module).__all__
                    assert {alias.name for alias in node.names} <= set(listed), page.name
                    found += 1
    assert found > 50


def test_top_level_names_are_those_of_their_modules() -> None:
    assert 10 <= len(paminsa_viz.__all__) <= 16
    for name in paminsa_viz.__all__:
        value = getattr(paminsa_viz, name)
        subpackage = importlib.import_module(f"paminsa_viz.{LATE['paminsa_viz'][name]}")
        assert value is getattr(subpackage, name)


ORDER = ("design", "geometry", "pose", "actuators", "velocity", "acceleration", "torque")


@pytest.mark.parametrize("name", ["paminsa_viz", "paminsa_viz.model"])
def test_arguments_come_in_one_order(name) -> None:
    """The design or its geometry first, then the pose, then what belongs to the pose."""
    module = importlib.import_module(name)
    for public_name in module.__all__:
        value = getattr(module, public_name)
        if inspect.isfunction(value):
            known = [ORDER.index(p) for p in inspect.signature(value).parameters if p in ORDER]
            assert known == sorted(known), public_name


def test_type_checkers_see_a_function_of_a_design_as_it_is_written() -> None:
    """With the name of its first argument, which may then be given as ``design=``."""
    hints = get_type_hints(of_design)
    assert hints["function"] == hints["return"]
    assert "Concatenate" not in str(hints["return"])  # which has types without names


def test_package_is_typed_and_has_one_version() -> None:
    root = Path(paminsa_viz.__file__).parent
    assert (root / "py.typed").exists()
    wanted = paminsa_viz.__version__
    assert re.fullmatch(r"\d+\.\d+\.\d+", wanted)
    project = (root.parent / "pyproject.toml").read_text()
    assert 'dynamic = ["version"]' in project
    assert f'"{wanted}"' not in project
