"""A design as text: TOML with a comment on every value, which `read_design` takes back exactly."""

from __future__ import annotations

from dataclasses import fields

from paminsa_viz.files.design_counterweights import counterweight_lines
from paminsa_viz.files.design_schema import KEY_OF, KNEE, SCHEMA_VERSION, TABLES, Key
from paminsa_viz.files.errors import DesignFileError, printable
from paminsa_viz.model.design import APPENDIX_4, Design

HEADER = """\
Design of a PAMINSA manipulator. All values are in SI units, named at the end of each key.
A value that is left out is Appendix 4's (delete value_count when you leave some out)."""

NAME_CHARACTERS = 200
"""Longest name of a design."""


def name_problem(name: object) -> str:
    """Return why a design's name cannot stand in a file, or an empty string if it can."""
    if not isinstance(name, str) or len(name) > NAME_CHARACTERS or not name.isprintable():
        return f"a name is one line of printable text of at most {NAME_CHARACTERS} characters"
    return ""


def write_design(design: Design, *, comment: str = "") -> str:
    """Return the text of a design file that reads back as the same design, to the last digit.

    Args:
        design: The design.
        comment: Where the file comes from, for its head; may have several lines.

    Raises:
        DesignFileError: If the design's name cannot stand in a file.
    """
    problem = name_problem(design.name)
    if problem:
        raise DesignFileError("design", problem, key="name", value=design.name)
    head = [*HEADER.splitlines(), *comment.splitlines()]
    lines = [f"# {printable(line)}".rstrip() for line in head]
    body: list[str] = []
    for table, keys in TABLES.items():
        rows = [(_assignment(design, key), _comment(design, key)) for key in keys.values()]
        width = max((len(assignment) for assignment, _ in rows), default=0)
        body += ["", f"[{table}]  {_table_comment(table)}".rstrip()] if table else []
        body += [f"{assignment:<{width}}  # {text}" for assignment, text in rows]
        if table == "geometry" and design.geometry.knee is not APPENDIX_4.geometry.knee:
            body.append(
                f'{KNEE} = "{design.geometry.knee.value}"  # upper knee: mirror of Appendix 1'
            )
    body += counterweight_lines(design)
    count = sum("=" in line and not line.startswith(("#", KNEE)) for line in body)
    # The version comes last, as a file without it is no design file: no cut goes unnoticed.
    lines += ["", f"name = {_string(design.name)}"]
    lines += [f"value_count = {count}  # so that a file that was cut short is noticed"]
    lines += [f"schema_version = {SCHEMA_VERSION}"]
    return "\n".join([*lines, *body]) + "\n"


def _string(text: str) -> str:
    escaped = text.replace("\\", "\\\\").replace('"', '\\"')
    return f'"{escaped}"'


def _assignment(design: Design, key: Key) -> str:
    text = f"{key.name} = {design.value(key.parameter.path)!r}"
    return f"# {text}" if _is_unset(design, key) else text


def _is_unset(design: Design, key: Key) -> bool:
    """Whether the design leaves the value to follow from others (the guide stroke)."""
    field = key.parameter.path.rpartition(".")[2]
    owner = getattr(design, key.table) if key.table else design
    return getattr(owner, field) is None


def _comment(design: Design, key: Key) -> str:
    parameter = key.parameter
    text = f"{parameter.symbol}, {parameter.label}"
    if design.value(parameter.path) != parameter.default:
        text += f" (Appendix 4: {parameter.default!r})"
    return text


def _table_comment(table: str) -> str:
    """Return the first sentence of the group's own documentation."""
    group = next(item for item in fields(APPENDIX_4) if item.name == table)
    text = (type(getattr(APPENDIX_4, group.name)).__doc__ or "").strip().splitlines()
    return f"# {text[0].rstrip('.')}" if text else ""


def differences(first: Design, second: Design) -> list[tuple[Key, float, float]]:
    """Return the values in which two designs differ, in the design's order.

    A guide stroke that is left open counts as the length it takes.
    """
    pairs = [(key, first.value(path), second.value(path)) for path, key in KEY_OF.items()]
    return [pair for pair in pairs if pair[1] != pair[2]]
