"""Pages of the documentation's site for the Python API, one a subpackage, made from the docstrings.

MkDocs calls this while it builds the site. Each public name has a heading, its signature, its
arguments, results and what is raised, and the site's search finds it.
"""

from __future__ import annotations

import importlib
import inspect
import re
import runpy
from pathlib import Path
from typing import Any

from mkdocs.config.defaults import MkDocsConfig
from mkdocs.structure.files import File, Files

SUBPACKAGES: dict[str, str] = runpy.run_path(str(Path(__file__).with_name("generate.py")))["API"]
"""Subpackages and what they are about."""


def on_config(config: MkDocsConfig) -> None:
    """Put the pages of the subpackages into the menu."""
    assert config.nav
    config.nav.append(
        {"Python API by subpackages": [{name: f"api/{name}.md"} for name in SUBPACKAGES]}
    )


def on_files(files: Files, config: MkDocsConfig) -> None:
    """Add a page for each subpackage; a name that several list stands in full in one of them."""
    pages: dict[str, str] = {}
    # The package itself lists names of its subpackages, which come first.
    for subpackage in sorted(SUBPACKAGES, key=lambda name: name == "paminsa_viz"):
        module = importlib.import_module(subpackage)
        blocks = [f"# {subpackage}\n\n{SUBPACKAGES[subpackage]}\n"]
        for name in module.__all__:
            path = _path(module, name)
            if path in pages:
                blocks.append(f"- [`{name}`]({pages[path]}.md#{path})")
            else:
                pages[path] = subpackage
                blocks.append(
                    f"\n::: {path}\n    options:\n      heading: {name}\n      toc_label: {name}\n"
                )
        files.append(File.generated(config, f"api/{subpackage}.md", content="\n".join(blocks)))


def on_page_markdown(markdown: str, page: Any, **_: Any) -> str:
    """Let the headings of the list of all names lead to the pages of the subpackages."""
    if page.file.src_uri != "python-api.md":
        return markdown
    return re.sub(r"^## (paminsa_viz[\w.]*)$", r"## [\1](api/\1.md)", markdown, flags=re.M)


def _path(module: Any, name: str) -> str:
    """Return the dotted path of a public name in the module that it is written in.

    Some functions are called as their module is; a constant does not know its own.
    """
    value = inspect.unwrap(getattr(module, name))
    home = getattr(value, "__module__", "") if getattr(value, "__name__", "") == name else ""
    return f"{home if home.startswith('paminsa_viz') else module.__name__}.{name}"
