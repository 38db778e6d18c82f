"""``paminsa-viz`` or ``paminsa-viz start``: the explorer in the browser."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import tyro

from paminsa_viz.cli import COMMANDS
from paminsa_viz.cli.arguments import PROGRAM, parse
from paminsa_viz.options import AppOptions

DESCRIPTION = f"""\
Explore the parallel manipulator PAMINSA: drag the pose, see the robot and its torque maps.

Without a command the explorer starts and opens in the browser. It runs on this machine and, unless
--host says otherwise, only this machine can reach it. Stop it with Ctrl-C.

Commands:
{chr(10).join(f"  {name:<10} {text}" for name, text in COMMANDS.items())}

'{PROGRAM} COMMAND --help' explains a command; '{PROGRAM} --version' prints the version."""


@dataclass(frozen=True)
class Start:
    """Flags of the explorer."""

    host: str = "127.0.0.1"
    """Address to listen on. 0.0.0.0 lets everybody in your network use the page: it has no
    password."""
    port: int = 8080
    """Port to listen on; 0 takes any free one. A port in use is an error."""
    browser: bool = True
    """Open the page in the browser."""
    design: Annotated[Path | None, tyro.conf.arg(metavar="FILE")] = None
    """Design file (TOML) to start with, instead of the paper's Appendix 4."""
    allow_host: Annotated[tuple[str, ...], tyro.conf.arg(metavar="NAME")] = ()
    """Another name under which a browser may open the page, such as robot.local."""


def main(words: list[str]) -> int:
    """Start the explorer and serve until it is stopped."""
    flags = parse(Start, words, "", DESCRIPTION)
    options = AppOptions(**vars(flags))

    from paminsa_viz import app  # the page's libraries take a second to load

    app.run(options)
    return 0
