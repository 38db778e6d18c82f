"""Reading the words of a command line into a typed value, with one-line errors."""

from __future__ import annotations

import inspect
import io
import math
import re
from collections.abc import Sequence
from contextlib import redirect_stderr
from contextvars import ContextVar
from dataclasses import MISSING, fields
from typing import TYPE_CHECKING, Any, Literal, TypeAlias, TypeVar, Union, get_args, get_type_hints

import tyro

from paminsa_viz.errors import PaminsaError, name_hint
from paminsa_viz.old_names import flags_of_today

command_line: ContextVar[str] = ContextVar("command_line")
"""The command that runs, as it was typed: provenance of what it writes."""


T = TypeVar("T")

OrNone: TypeAlias = Union[None, T]  # noqa: RUF036, UP007
"""A flag that may be left out. With ``T | None`` instead, or with None in the second place, tyro
loads typeguard to compare the default, which takes as long as loading NumPy."""

if TYPE_CHECKING:
    from typing import Annotated as OneOf

    Words: TypeAlias = tuple[str, ...]
else:

    class OneOf:
        """A flag that is one of the words of a registry: ``OneOf[str, tuple(REGISTRY)]``.

        To tyro it is a `Literal`, to a type checker, which takes no words from a variable, a str.
        """

        def __class_getitem__(cls, item: tuple[type[str], tuple[str, ...]]) -> Any:
            _, words = item
            return Literal[words]

    # that is what a bare tuple means to tyro, and of other tuples typeguard compares the default
    Words = tuple
"""A flag of a word that can be repeated."""


class UsageError(PaminsaError):
    """Invalid arguments."""


def parse(kind: Any, words: Sequence[str], program: str, description: str) -> Any:
    """Return an instance of ``kind``, a dataclass or a union of subcommands, from words.

    Args:
        kind: What to make.
        words: The words after the command's name.
        program: Name of the program and the command.
        description: What its ``--help`` says first.

    Raises:
        UsageError: If the words do not fit.
        SystemExit: After ``--help``.
    """
    words = flags_of_today(list(words))
    _check_subcommand(kind, words, program)
    message = io.StringIO()
    if not {"-h", "--help"}.isdisjoint(words):
        from paminsa_viz.cli.help import described

        print(f"{description}\n")  # tyro would run its lines together
        kind = described(kind)
    try:
        with redirect_stderr(message):
            found = tyro.cli(
                kind,
                args=words,
                prog=program,
                description=" ",
                config=(tyro.conf.OmitArgPrefixes, tyro.conf.UseAppendAction),
            )
    except SystemExit as stop:
        if not stop.code:
            raise
        told = one_line(message.getvalue())
        if left_over := re.match(r"Unrecognized options: ([^-,][^,]*)", told):
            told = f"{left_over[1]!r} is left over: {_takes(kind, words, program)}"
        raise UsageError(f"{told}; see {program} --help") from None
    if repeated := _repeated_flag(found, words):
        raise UsageError(f"{repeated} takes one value, but is given twice; see {program} --help")
    return found


def _check_subcommand(kind: Any, words: Sequence[str], program: str) -> None:
    """Refuse a first word that is none of the subcommands: tyro takes it for a flag."""
    if inspect.isclass(kind) or not words or words[0].startswith("-"):
        return
    names = [get_args(one)[1].name for one in get_args(kind)]
    if words[0] not in names:
        hint = name_hint(words[0], names)
        raise UsageError(f"there is no command '{program} {words[0][:40]}'; {hint}")


def _takes(kind: Any, words: Sequence[str], program: str) -> str:
    """Return what a command takes besides its flags, in words."""
    if not inspect.isclass(kind):
        commands = {mark.name: one for one, mark in map(get_args, get_args(kind))}
        name = next(word for word in words if word in commands)
        kind, program = commands[name], f"{program} {name}"
    marks = [get_args(hint)[1:] for hint in get_type_hints(kind, include_extras=True).values()]
    named = [mark[-1].metavar for mark in marks if tyro.conf.Positional in mark]
    most = f"at most {len(named)}, " if len(named) > 1 else ""
    return f"besides flags {program} takes {most}{' '.join(named) or 'nothing'}"


def _repeated_flag(found: Any, words: Sequence[str]) -> str | None:
    """Return a flag of one value that stands twice among the words: tyro keeps its last value."""
    given = [word.partition("=")[0].replace("_", "-") for word in words]
    for field in fields(found):
        flag = f"--{field.name.replace('_', '-')}"
        of_one_value = field.default != () and not isinstance(field.default, bool)
        if of_one_value and given.count(flag) > 1:
            return flag
    return None


def check_needs(flags: Any, allowed: object, needed: str, *names: str) -> None:
    """Refuse flags that would change nothing without another one.

    Args:
        flags: Instance of a command's dataclass.
        allowed: Whether what they need is there.
        needed: What they need, in words.
        names: Fields of the flags; one with the value of its default counts as left out.

    Raises:
        UsageError: The first of them that is given.
    """
    for field in fields(flags):
        if not allowed and field.name in names and getattr(flags, field.name) != field.default:
            raise UsageError(f"--{field.name.replace('_', '-')} needs {needed}")


def check_limits(flags: Any, *names: str) -> None:
    """Refuse limits that are given and not above 0, in the units and by the names of their flags.

    Args:
        flags: Instance of a command's dataclass.
        names: Fields of the flags; None is no limit.

    Raises:
        UsageError: The first of them, and its value.
    """
    for name in names:
        limit = getattr(flags, name)
        if limit is not None and not (math.isfinite(limit) and limit > 0):
            flag = f"--{name.replace('_', '-')}"
            raise UsageError(f"{flag}: a finite limit above 0 is needed, not {limit!r}")


def given_flag(flags: Any, name: str) -> str:
    """Return the flag of a field that has been given, such as ``--cut-off``; empty if none was.

    Args:
        flags: Instance of a command's dataclass.
        name: Name of the field; there may be none. Of a positional argument there is no flag.
    """
    for field in fields(flags):
        if field.name == name and field.default is not MISSING:
            given = getattr(flags, name) != field.default
            return f"--{name.replace('_', '-')}" if given else ""
    return ""


def one_line(message: str) -> str:
    """Return the first statement of tyro's message, and its suggestion, as one line.

    It is a title and statements with rules between them, in a drawn frame or, on a screen
    without line drawing, below a dashed rule.
    """
    statements: list[list[str]] = [[]]
    for framed in re.sub(r"\x1b\[[\d;]*m", "", message).splitlines():
        line = framed.strip("│").rstrip()
        if re.match(r"[╭╰]|\s*[─-]{4}", line):
            statements.append([])
        elif line.strip() and not line.startswith(" " * 8):  # there is a flag's help text
            statements[-1].append(line.strip())
    texts = [" ".join(lines).rstrip(".") for lines in statements if lines]
    if "╭" not in message:
        del texts[:1]  # the title
    for pattern, needed in _TYPES.items():
        texts[:1] = [re.sub(pattern, needed, text) for text in texts[:1]]
    texts[:1] = [re.sub(_SEVERAL, _count_values, text) for text in texts[:1]]
    texts[:1] = [re.sub(_CHOICE, _name_choice, text) for text in texts[:1]]
    # without the words that a flag takes, which --help lists: some are a hundred
    meant = [re.sub(r" \{.*?\}", "", text) for text in texts[1:] if text.startswith("Perhaps")]
    kept = texts[:1] + meant
    return "; ".join(kept) or "the arguments do not fit"


_SEVERAL = r"(?i)((?:(?:str|float|int|typing\.Literal\[.*?\]),? ?){2,}) is needed"


def _count_values(found: re.Match[str]) -> str:
    choices = [f"one of {', '.join(c)} and " for c in _choices(found[1])]
    kinds = re.findall(r"[a-z]+", re.sub(r"\[.*?\]", "", found[1]).lower())
    names = "a name and " * kinds.count("str") + "".join(choices)
    numbers = kinds.count("float") + kinds.count("int")
    return f"{names}{numbers} number{'s' * (numbers > 1)} are needed"


def _choices(kinds: str) -> list[list[str]]:
    """Return the words of each ``typing.Literal[...]`` in a text."""
    return [re.findall(r"'([^']*)'", each) for each in re.findall(r"Literal\[(.*?)\]", kinds)]


_CHOICE = r"invalid choice '(.*)' for argument '(.*)'\. Expected one of \((.*)\)"


def _name_choice(found: re.Match[str]) -> str:
    """Return advice for a word that is no choice; tyro lists them in any order, and None too."""
    word, flag, listed = found.groups()
    choices = sorted(name for name in re.findall(r"'([^']*)'", listed) if name != "None")
    return f"{flag}: invalid choice {word!r}; {name_hint(word.lower(), choices)}"


_TYPES = {
    r"no type matching (?:\{None\}\|)?\{?(.+?)\}? could be instantiated from \[(.*?)\]\. Got.*": (
        r"\1 is needed, not \2"
    ),
    r"Could not parse arguments \[(.*)\] into tuple type tuple\[(.*)\]": r"\2 is needed, not \1",
    r"Error parsing [A-Za-z]+: (.*)": r"\1",
    r"Error parsing (\S+: )": r"\1",
    r"Missing value for argument '(.*)'\. Expected 1 values": r"\1: a value is needed",
    r"Missing value for argument '(.*)'\. Expected (\d+) values": r"\1: \2 values are needed",
    r"invalid literal for int\(\) with base 10: (.*)": r"a whole number is needed, not \1",
    r"could not convert string to float: (.*)": r"a number is needed, not \1",
    r"(?<=: )INT is needed": "a whole number is needed",
    r"(?<=: )FLOAT is needed": "a number is needed",
    r" is needed, not $": " is needed",
}
"""Errors of tyro and Python about a value of another type, and the text shown instead."""
