"""The first page of the documentation's site is the README, whose links count from another folder.

MkDocs calls this while it builds the site.
"""

from __future__ import annotations

import re
from pathlib import Path

from mkdocs.config.defaults import MkDocsConfig
from mkdocs.structure.files import File, Files

README = Path(__file__).parent.parent / "README.md"


def on_files(files: Files, config: MkDocsConfig) -> None:
    """Add the page; what a link outside of the site leads to is named without it."""
    text = re.sub(r"\[([^]]*)\]\(([^)]+)\)", _link, README.read_text(encoding="utf-8"))
    files.append(File.generated(config, "index.md", content=text))


def _link(found: re.Match[str]) -> str:
    text, target = found.groups()
    if "://" in target:
        return found[0]
    return f"[{text}]({target[5:]})" if target.startswith("docs/") else text
