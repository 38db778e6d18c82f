"""Runs the page's formulas without a browser."""

from __future__ import annotations

import json
import subprocess
from pathlib import Path
from typing import Any

from paminsa_viz.explorer.core import persistence
from paminsa_viz.explorer.features.one_file import one_file
from paminsa_viz.explorer.state.document import Document

DRAWS = "/**\n * The robot in WebGL2"
"""Where the part of the page begins that needs a browser."""


def run_in_node(body: str, documents: list[Document], folder: Path) -> Any:
    """Return what a function body returns, with the texts of documents as ``given``.

    The page is written with the first of them.
    """
    text = one_file(documents[0])
    script = text[text.index("const PAGE") : text.index(DRAWS)]
    run = f"""
const fs = require("fs");
const run = (given) => {{ {body} }};
const given = JSON.parse(fs.readFileSync("given", "utf8"));
fs.writeFileSync("found", JSON.stringify(run(given)));
"""
    (folder / "page.js").write_text(script + run, encoding="utf-8")
    (folder / "given").write_text(json.dumps([persistence.dump(each) for each in documents]))
    subprocess.run(["node", "page.js"], cwd=folder, check=True)
    return json.loads((folder / "found").read_text())
