"""The documentation: pages that follow from the source, links, code that runs, commands in line."""

from __future__ import annotations

import ast
import json
import re
import runpy
import shlex
import sys
from dataclasses import replace
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path

import pytest

import paminsa_viz
from paminsa_viz import synthesis
from paminsa_viz.cli import COMMANDS, command_module
from paminsa_viz.cli.arguments import parse
from paminsa_viz.explorer.tabs import sections
from paminsa_viz.files.design_file import read_design

ROOT = Path(__file__).parent.parent
DOCS = ROOT / "docs"
PAGES = sorted([*DOCS.glob("*.md"), *ROOT.glob("*.md"), *ROOT.glob("[bep]*/README.md")])
OF_TODAY = [page for page in PAGES if page.stem != "CHANGELOG"]
GENERATOR = runpy.run_path(str(DOCS / "generate.py"))
GENERATED = GENERATOR["PAGES"]


def name_of(path: Path) -> str:
    return str(path.relative_to(ROOT))


@pytest.mark.slow
@pytest.mark.parametrize("page", GENERATED)
def test_pages_made_from_the_source_are_up_to_date(page) -> None:
    made = GENERATED[page]()
    assert (DOCS / page).read_text(encoding="utf-8") == made, "run python docs/generate.py"


def anchors(path: Path) -> set[str]:
    """Return the names that links may go to: headings as GitHub and MkDocs write them."""
    text = re.sub(r"^```.*?^```", "", path.read_text(encoding="utf-8"), flags=re.M | re.S)
    heads = re.findall(r"^#+ (.+)$", text, re.M)
    plain = (re.sub(r"[^\w\s-]", "", head.lower()).strip() for head in heads)
    return {re.sub(r"\s", "-", head) for head in plain}


@pytest.mark.slow
def test_targets_of_links_and_pictures_exist() -> None:
    for page in PAGES:
        text = re.sub(r"^```.*?^```", "", page.read_text(encoding="utf-8"), flags=re.M | re.S)
        for target in re.findall(r"\]\(([^)\s]+)\)", text):
            if re.match(r"https?:|mailto:", target):
                continue
            place, _, anchor = target.partition("#")
            found = (page.parent / place).resolve() if place else page
            assert found.exists(), f"{name_of(page)} links to {target}"
            if page.parent == DOCS:
                assert found.is_relative_to(DOCS), f"{target} is outside the site of {page.name}"
            if anchor:
                assert anchor in anchors(found), f"{name_of(page)} links to {target}"


def test_modules_that_pages_name_exist() -> None:
    for page in OF_TODAY:
        named = re.findall(r"`(paminsa_viz(?:\.[a-z_\d]+)+)`", page.read_text(encoding="utf-8"))
        for path in named:
            module, _, last = path.rpartition(".")
            found = hasattr(import_module(module), last) or find_spec(path)
            assert found, f"{name_of(page)} names {path}"


def test_every_page_is_in_the_menu() -> None:
    menu = re.findall(r"([\w-]+\.md)$", (ROOT / "mkdocs.yml").read_text(), re.M)
    assert sorted(menu) == sorted(["index.md", *(page.name for page in DOCS.glob("*.md"))])


def test_the_first_page_leads_to_every_page() -> None:
    """The README, which is that of the site as well."""
    listed = re.findall(r"\]\(docs/([\w-]+\.md)", (ROOT / "README.md").read_text(encoding="utf-8"))
    assert set(listed) == {page.name for page in DOCS.glob("*.md")}


@pytest.mark.slow
def test_site_is_built_without_warnings_and_its_search_finds_all_public_names(tmp_path) -> None:
    """Signatures stay on one line, as a process for each broken one takes a quarter of the time."""
    building = pytest.importorskip("mkdocs.commands.build")
    pytest.importorskip("mkdocstrings")
    config = import_module("mkdocs.config").load_config(
        str(ROOT / "mkdocs.yml"), site_dir=str(tmp_path)
    )
    assert config.strict  # the first warning ends it
    config.plugins["mkdocstrings"].config.handlers["python"]["options"]["line_length"] = 10_000
    depth = sys.getrecursionlimit()
    try:
        building.build(config)
    finally:
        sys.setrecursionlimit(depth)  # mkdocstrings raises it
    assert (tmp_path / "design-file" / "index.html").exists()
    assert not (tmp_path / "generate.py").exists()
    entries = json.loads((tmp_path / "search" / "search_index.json").read_text())["docs"]
    found = {entry["title"] for entry in entries if entry["location"].startswith("api/")}
    for package in GENERATOR["API"]:
        assert set(import_module(package).__all__) <= found, package


CODE = [
    pytest.param(
        code,
        id=f"{name_of(page)}:{number}",
        marks=pytest.mark.slow if page.stem == "synthesis" else (),  # it searches
    )
    for page in PAGES
    for number, code in enumerate(
        re.findall(r"^```python\n(.*?)^```", page.read_text(encoding="utf-8"), re.M | re.S)
    )
]


@pytest.mark.slow
@pytest.mark.parametrize("code", CODE)
def test_python_in_the_documentation_runs(code, tmp_path, monkeypatch) -> None:
    """As it stands; searches end after a few generations."""
    monkeypatch.chdir(tmp_path)
    whole = synthesis.load_case
    short = synthesis.Effort(generations=6, population=4)
    monkeypatch.setattr(synthesis, "load_case", lambda path: replace(whole(path), effort=short))
    exec(compile(code, "documentation", "exec"), {})


def test_readme_lists_every_command() -> None:
    text = (ROOT / "README.md").read_text(encoding="utf-8")
    rows = re.findall(r"^\|[^|]+\|[^|]+\|([^|]+)\|$", text, re.M)
    listed = [words.split()[0] for row in rows for words in re.findall(r"`([a-z][^`]*)`", row)]
    assert set(listed) == set(COMMANDS)


def commands() -> list[str]:
    """Return the command lines that the pages show, those over two lines as one."""
    found = set()
    for page in PAGES:
        text = re.sub(r" \\\n +", " ", page.read_text(encoding="utf-8"))
        lines = re.findall(r"^ *(?:\.venv/bin/)?(paminsa-viz [a-z].*)$", text, re.M)
        found.update(line.split("  ")[0].strip() for line in lines)
    return sorted(found)


@pytest.mark.slow
@pytest.mark.usefixtures("parsers_made_once")
def test_flags_of_commands_in_the_documentation_are_known() -> None:
    """Their flags are known; what they would do is the business of other tests."""
    for words in commands():
        name, *rest = shlex.split(words)[1:]
        assert parse(command_module(name).FLAGS, rest, name, ""), words


def test_commands_over_two_lines_can_be_pasted_into_a_shell() -> None:
    shown = r"^( *)(?:\.venv/bin/)?paminsa-viz [a-z].*[^\\\n](?=\n\1 +\S)"
    for page in PAGES:
        cut = re.search(shown, page.read_text(encoding="utf-8"), re.M)
        assert not cut, f"{name_of(page)} needs a backslash behind {cut and cut[0]}"


def test_changelog_begins_with_this_version_and_readme_cites_it() -> None:
    text = (ROOT / "CHANGELOG.md").read_text(encoding="utf-8")
    heads = re.findall(r"^## \[([^\]]+)\]", text, re.M)
    assert paminsa_viz.__version__ in heads[:2]
    readme = (ROOT / "README.md").read_text(encoding="utf-8")
    assert f"  version = {{{paminsa_viz.__version__}}}," in readme


def test_files_that_pages_name_exist() -> None:
    folders = ("paminsa_viz", "tests", "docs", "examples", "benchmarks", "assets")
    found = [path for folder in folders for path in (ROOT / folder).rglob("*.py")]
    every = [name_of(path) for path in (*found, *ROOT.glob("*.py"))]
    for page in PAGES:
        text = page.read_text(encoding="utf-8")
        for name in re.findall(r"`([\w./]+\.py)`", text):
            known = "NAME" in name or any(f"/{path}".endswith(f"/{name}") for path in every)
            assert known, f"{name_of(page)} names {name}"


@pytest.mark.slow
def test_tabs_that_texts_name_exist() -> None:
    """Of the page's two docks; in pages, hints and templates."""
    tabs = {"Answer", *(one.name for one in sections().values())}
    sources = [
        path for kind in ("py", "j2", "js") for path in (ROOT / "paminsa_viz").rglob(f"*.{kind}")
    ]
    for path in (*PAGES, *sources):
        named = re.findall(r"\btabs? \*?([A-Z][a-z]+)", path.read_text(encoding="utf-8"))
        assert tabs.issuperset(named), f"{name_of(path)} names the tabs {named}"


def test_defaults_in_the_reference_of_design_files_can_be_written() -> None:
    text = (DOCS / "design-file.md").read_text(encoding="utf-8")
    lines = ["schema_version = 1"]
    head = r"^## \[(\w+)\](?: to \[leg3\])?\n"
    for table, section in re.findall(head + "(.*?)(?=^## )", text, re.M | re.S):
        rows = [line.strip("| ").split(" | ") for line in re.findall(r"^\| `.*$", section, re.M)]
        given = [(row[0], row[3]) for row in rows if len(row) == 5]
        lines.append(f"[{table}]")
        lines += [
            f"{key.strip('`')} = {default.strip('`')}"
            for key, default in given
            if default not in ("as l_B10", "rigid")
        ]
    assert len(lines) > 130
    read_design("\n".join(lines), "reference.toml")


TYPED = r'[<>]= [^ ]+ N m|"N m"'
"""Requirements and code, which are in ASCII."""


def test_pages_write_units_of_torque_in_one_way() -> None:
    """So do the helps of flags, which one of them is made of."""
    for page in PAGES:
        text = re.sub(r"^ *```.*?^ *```", "", page.read_text(encoding="utf-8"), flags=re.M | re.S)
        lines = re.sub(TYPED, "", text).splitlines()
        wrong = [line for line in lines if re.search(r"\bN m\b|kg m²", line)]
        assert not wrong, name_of(page)


@pytest.mark.slow
def test_texts_for_people_write_units_of_torque_as_the_pages_do() -> None:
    """Units alone, such as ``"N m/rad"``, become ``N·m/rad`` where they are shown."""
    keys = {"load of the motion [N, N, N, N m, N m, N m]"}  # of a table
    for path in sorted((ROOT / "paminsa_viz").rglob("*.py")):
        source = path.read_text(encoding="utf-8")
        if "N m" not in source:
            continue
        tree = ast.parse(source)
        says = {id(node.value) for node in ast.walk(tree) if isinstance(node, ast.Expr)}
        texts = [
            re.sub(TYPED, "", node.value)
            for node in ast.walk(tree)
            if isinstance(node, ast.Constant) and isinstance(node.value, str)
            and id(node) not in says
        ]  # fmt: skip
        wrong = {text for text in texts if re.search(r"\bN m\b", text)} - keys
        assert {text for text in wrong if not re.fullmatch(r"N m( s)?(/rad)?", text)} == set(), path


def test_paths_to_sections_that_pages_name_exist() -> None:
    """A workspace and its section, as *Robot, Load* or in words; the folder *File > Export*."""
    known = {tuple(path.split("/")) for path in sections()} | {("File", "Export")}
    for page in OF_TODAY:
        text = re.sub(r"\s+", " ", page.read_text(encoding="utf-8"))
        paths = re.findall(r"(?<!\*)\*([A-Z]\w+(?:(?:, | → | > )[A-Z]\w+)+)\*(?!\*)", text)
        named = [tuple(re.split(", | → | > ", path)[:2]) for path in paths]
        named += re.findall(r"workspace \*(\w+)\*, section \*(\w+)\*", text)
        assert known.issuperset(named), f"{name_of(page)} names {named}"


@pytest.mark.slow
def test_names_in_docstrings_exist() -> None:
    """Names in single back quotes are those of the package, or of what it imports."""
    known: set[str] = set()
    used: list[tuple[str, str]] = []
    for path in sorted((ROOT / "paminsa_viz").rglob("*.py")):
        known.update(path.with_suffix("").parts)
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            match node:
                case ast.FunctionDef(name=name) | ast.ClassDef(name=name) | ast.Name(id=name):
                    known.add(name)
                case ast.Attribute(attr=name) | ast.arg(arg=name):
                    known.add(name)
                case ast.Import(names=names) | ast.ImportFrom(names=names):
                    module = getattr(node, "module", None) or ""
                    known.update(module.split("."), *(item.name.split(".") for item in names))
                case ast.Expr(value=ast.Constant(value=str(text))):
                    found = re.findall(r"(?<!`)`([A-Za-z_][\w.]*\w)`(?!`)", text)
                    used += [(name_of(path), name) for name in found]
    for place, name in used:
        assert known.issuperset(name.split(".")), f"{place} names {name}"


def test_no_two_classes_have_the_same_name() -> None:
    named: dict[str, str] = {}
    for path in sorted((ROOT / "paminsa_viz").rglob("*.py")):
        for name in re.findall(r"(?m)^class (\w+)", path.read_text(encoding="utf-8")):
            other = named.setdefault(name, name_of(path))
            assert other == name_of(path), f"{name} stands in {other} and {name_of(path)}"


def test_the_table_of_workspaces_names_every_section() -> None:
    page = (DOCS / "page.md").read_text(encoding="utf-8")
    rows = dict(re.findall(r"(?m)^\| (\w+) \| [^|]+\? \| ([^|]+) \|", page))
    named = {f"{space}/{name}" for space, names in rows.items() for name in names.split(", ")}
    assert named == set(sections())
