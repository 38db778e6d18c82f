"""The command line ``paminsa-viz``.

Each command is a module with its flags, ``FLAGS``, whose ``run()`` returns the exit code, and a
``DESCRIPTION`` for its help. It is imported only when it runs, so that a small command does not
wait for the page's libraries.

Exit codes: 0 done; 1 a negative result, such as a verification that failed, a motion that cannot be
run, bounds that cannot be met; 2 a wrong argument or file, with one line on stderr that names the
place, or too little memory; 130 stopped with Ctrl-C.
"""

from __future__ import annotations

import errno
import os
import sys
from collections.abc import Sequence
from contextlib import suppress
from importlib import import_module
from io import TextIOWrapper
from types import ModuleType

from paminsa_viz import interrupts
from paminsa_viz.cli.letters import SPELLED
from paminsa_viz.errors import InvalidInput, PaminsaError, name_hint
from paminsa_viz.version import COMMAND, __version__

__all__ = ["COMMANDS", "command_module", "main"]

COMMANDS: dict[str, str] = {
    "start": "open the explorer in the browser (also without any command)",
    "evaluate": "compute actuator positions, torques and status for a table of poses",
    "design": "check, show, compare design files; write Appendix 4's",
    "map": "map torques and other quantities over the workspace, as figures and tables",
    "trajectory": "required actuator torques of a motion; draw, simulate, write it",
    "drives": "find motors and gears for a motion; their feasible ratios",
    "loads": "forces at the joints and in the bars, at rest or along a motion; bearing loads",
    "accuracy": "errors of the pose that drives, tolerances and clearances leave",
    "calibrate": "identify each leg's lengths from measured poses; the corrected design",
    "excite": "find the motion that shows masses and friction best, for identify",
    "identify": "find masses, balance and friction of the built robot from a log",
    "stiffness": "stiffness, deflection under load and what to stiffen first, at a pose",
    "clearance": "least distance of the robot's bodies and which two, at a pose and over poses",
    "requirements": "check what a robot is needed for; the volume where it holds",
    "sweep": "measure many designs over the workspace, into a resumable table",
    "synthesize": "find the lengths of the robot that meets requirements and is smallest",
    "balance": "find the masses that balance the robot best, certified optimal",
    "verify": "check the formulas against MuJoCo and Pinocchio",
    "report": "write a design report as one HTML file",
    "page": "write the explorer in one HTML file, which needs no server",
    "export": "write the robot for other programs: GLB, MuJoCo, USD, URDF, DXF",
    "code": "write the robot as C code for its controller, with test vectors",
}
"""Commands and what they do. Each is the module of its name in this package."""


def command_module(command: str) -> ModuleType:
    """Import the module of a command: the application itself for ``start``."""
    return import_module("paminsa_viz.app" if command == "start" else f"{__name__}.{command}")


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command and return its exit code.

    Args:
        arguments: Words after the program's name. None takes them from ``sys.argv``; this is the
            program itself then, whose process Ctrl-C ends.
    """
    if arguments is None:
        # before NumPy is imported: its threads of small linear algebra wait for each other
        os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
        try:
            interrupts.exit_on_interrupt(COMMAND)
        except RuntimeError as error:
            return _report_refused(error)
        for name in ("stdout", "stderr"):
            if getattr(sys, name) is None:  # closed by who starts it, or there is no console
                setattr(sys, name, open(os.devnull, "w", encoding="utf-8"))  # noqa: SIM115
        if isinstance(sys.stdout, TextIOWrapper):  # a code page may lack letters such as theta
            sys.stdout.reconfigure(errors=SPELLED)
        try:
            return _exit_code(sys.argv[1:])
        finally:
            interrupts.ignore_interrupts()
    return _exit_code(list(arguments))


def _exit_code(words: list[str]) -> int:
    try:
        try:
            code = _run(words)
        finally:  # after --help as well, which ends the program
            _flush_output()
    except KeyboardInterrupt:
        code = interrupts.EXIT_CODE
    except (MemoryError, RuntimeError) as error:
        code = _report_refused(error)
    except (PaminsaError, OSError) as error:
        if isinstance(error, BlockingIOError) and not hasattr(error, "characters_written"):
            code = _report_refused(error)  # of a process that was to start: nothing was written
        else:
            code = 1 if isinstance(error, OSError) and _reader_has_gone(error) else _report(error)
    for stream in (sys.stdout, sys.stderr):
        try:
            stream.flush()
        except OSError:  # Python would report it once more at its exit
            os.dup2(os.open(os.devnull, os.O_WRONLY), stream.fileno())
    return code


def _report_refused(error: Exception) -> int:
    """Print what the system lets this program have no more of, and return the exit code.

    Raises:
        Exception: The error, if it is another one.
    """
    if isinstance(error, MemoryError):
        text = "there is not enough memory; fewer cells, poses or workers need less, and ulimit -v"
        text += " may limit it"
    elif isinstance(error, BlockingIOError) or "start new thread" in str(error):
        text = "the system starts no more threads or processes: end others, use fewer workers, or"
        text += " raise their limit (ulimit -u, or the container's)"
    else:
        raise error
    with suppress(OSError):  # nothing is imported for it, which may fail too
        sys.stderr.write(f"{COMMAND}: {text}\n")
    return 2


def _report(error: PaminsaError | OSError) -> int:
    """Print an error, and return its exit code."""
    from paminsa_viz.cli.output import print_error

    found: Exception = error
    if isinstance(error, OSError) and error.errno == errno.ENOSPC and error.filename is None:
        found = _output_error(error)  # of a long text, which was not kept until the end
    with suppress(OSError):  # the error stream may be lost, too
        print_error(found)
    return 2


def _reader_has_gone(error: OSError) -> bool:
    """Return whether nobody reads the output any more (`| head`)."""
    # On Windows that is an invalid argument, of no file.
    invalid = sys.platform == "win32" and error.errno == errno.EINVAL and error.filename is None
    return isinstance(error, BrokenPipeError) or invalid


def _flush_output() -> None:
    """Write what is still to be printed.

    Raises:
        OSError: If nobody reads it.
        FileError: If it cannot be written: it may go to a disk that is full.
    """
    try:
        sys.stdout.flush()
    except OSError as error:
        if _reader_has_gone(error):
            raise
        raise _output_error(error) from error


def _output_error(error: OSError) -> Exception:
    from paminsa_viz.files.atomic import as_file_error

    return as_file_error("the output", error, "written")


def _as_typed(words: list[str]) -> str:
    """Return words as one line for the system's shell."""
    if sys.platform == "win32":
        from subprocess import list2cmdline as join
    else:
        from shlex import join
    return join(words)


def _run(words: list[str]) -> int:
    # Late, as all of it takes time in which the program can be stopped already.
    import warnings

    from paminsa_viz.cli.arguments import UsageError, command_line, given_flag, parse

    if words[:1] in (["--version"], ["-V"]):
        print(f"{COMMAND} {__version__}")
        return 0
    command_line.set(_as_typed([COMMAND, *words]))
    named = bool(words) and not words[0].startswith("-")
    name = words.pop(0) if named else "start"
    if name not in COMMANDS:
        raise UsageError(f"there is no command {name[:40]!r}; {name_hint(name, COMMANDS)}")
    with warnings.catch_warnings():
        # A number too large for the arithmetic ends as NaN or is refused; what NumPy has to say of
        # it names no place.
        warnings.simplefilter("ignore", RuntimeWarning)
        module = command_module(name)
        if name != "start" and sys.stderr.isatty():
            from paminsa_viz.cli.output import announce_compilation

            announce_compilation()
        program = COMMAND if name == "start" else f"{COMMAND} {name}"
        flags = parse(module.FLAGS, words, program, module.DESCRIPTION)
        try:
            return flags.run()
        except InvalidInput as error:
            # of a function, whose argument has the flag's value, and may say its unit or record
            name = error.argument.removeprefix("effort.").removesuffix("_mm")
            if flag := given_flag(flags, name):
                raise UsageError(f"{flag}: {error.problem}") from error
            raise
