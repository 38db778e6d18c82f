"""The command line ``paminsa-viz``.

Each command is a module with ``main(words) -> exit code``, imported only when it runs, so that a
small command does not wait for the page's libraries.

Exit codes: 0 done; 1 a negative result, such as a verification that failed, a motion that cannot be
run, bounds that cannot be met; 2 a wrong argument or file, with one line on stderr that names the
place; 130 stopped with Ctrl-C.
"""

from __future__ import annotations

import difflib
import importlib
import os
import sys
import warnings
from collections.abc import Sequence

from paminsa_viz import __version__
from paminsa_viz.cli.arguments import PROGRAM, UsageError, print_error
from paminsa_viz.errors import PaminsaError

COMMANDS: dict[str, str] = {
    "start": "open the explorer in the browser (also without any command)",
    "evaluate": "compute actuator positions, torques and status for a table of poses",
    "design": "check, show, compare design files; write Appendix 4's",
    "map": "map torques and other quantities over the workspace, as figures and tables",
    "trajectory": "required actuator torques of a motion; draw, simulate, write it",
    "sweep": "measure many designs over the workspace, into a resumable table",
    "balance": "find the masses that balance the robot best, certified optimal",
    "verify": "check the formulas against MuJoCo and Pinocchio",
    "report": "write a design report as one HTML file",
    "export": "write the robot as GLB, or as a MuJoCo model with or without meshes",
}
"""Commands and what they do."""


def module_of(command: str) -> str:
    """Return the module of a command: the application itself for ``start``."""
    return "paminsa_viz.app" if command == "start" else f"paminsa_viz.cli.{command}"


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command and return its exit code.

    Args:
        arguments: Words after the program's name; None takes them from ``sys.argv``.
    """
    words = list(sys.argv[1:] if arguments is None else arguments)
    try:
        with warnings.catch_warnings():
            # A number too large for the arithmetic ends as NaN or is refused; what NumPy has to
            # say of it names no place.
            warnings.simplefilter("ignore", RuntimeWarning)
            return _run(words)
    except KeyboardInterrupt:
        return 130
    except BrokenPipeError:
        # Whoever read the output has gone (`| head`). Python would report it once more at its exit.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 1
    except (PaminsaError, OSError) as error:
        print_error(error)
        return 2


def _run(words: list[str]) -> int:
    if words[:1] in (["--version"], ["-V"]):
        print(f"{PROGRAM} {__version__}")
        return 0
    name = "start"
    if words and not words[0].startswith("-"):
        name = words.pop(0)
    if name not in COMMANDS:
        near = difflib.get_close_matches(name, COMMANDS, 1)
        hint = f"did you mean {near[0]}?" if near else f"there are {', '.join(COMMANDS)}"
        raise UsageError(f"there is no command {name[:40]!r}; {hint}")
    code = importlib.import_module(module_of(name)).main(words)
    sys.stdout.flush()
    return code
