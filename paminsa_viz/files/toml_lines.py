"""Lines of a TOML text, for messages that name one."""

from __future__ import annotations


def find_line(text: str, key: str) -> int | None:
    """Return the line of a TOML text, counted from 1, that sets a dotted key or opens a table.

    Reads headings and plain assignments only, which is what design files consist of; None if the
    key is not found that way. The tables of a list are numbered: ``"counterweights.1.bar"``. One
    pass over the text, by hand: a pattern could take quadratic time on a hostile one.
    """
    table = ""
    counts: dict[str, int] = {}
    for number, line in enumerate(text.split("\n") if key else (), 1):
        line = line.strip()
        if line.startswith("["):
            table = path = _plain(line.lstrip("[").partition("]")[0])
            if line.startswith("[["):
                counts[path] = counts.get(path, -1) + 1
                table = path = f"{path}.{counts[path]}"
        else:
            name = _left_side(line)
            path = f"{table}.{_plain(name)}" if table else _plain(name)
            if not name:
                continue
        if path == key or path.startswith(f"{key}."):
            return number
    return None


def nearest_line(text: str, key: str) -> int | None:
    """Return the line of a dotted key, or of the innermost table around it that has one."""
    line = None
    while key and line is None:
        line = find_line(text, key)
        key = key.rpartition(".")[0]
    return line


def _left_side(line: str) -> str:
    """Return the text before the first ``=`` outside of quotes, empty without one."""
    quote = ""
    for place, character in enumerate(line):
        if quote:
            quote = "" if character == quote else quote
        elif character in "\"'":
            quote = character
        elif character in "#=":
            return line[:place] if character == "=" else ""
    return ""


def _plain(dotted: str) -> str:
    """Return a dotted key without quotes and the blanks around its dots."""
    return ".".join(part.strip().strip("\"'") for part in dotted.split("."))
