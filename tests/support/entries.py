"""The entries of the page's sections, those in folders and tabs as well."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from paminsa_viz.explorer.kit.entries import Entry
from paminsa_viz.explorer.kit.inputs import Input


def flat(entries: Sequence[Entry]) -> Iterator[Entry]:
    """Yield the entries of a table, each followed by those in it."""
    for entry in entries:
        yield entry
        for inner in (getattr(entry, "entries", ()), *getattr(entry, "tabs", {}).values()):
            yield from flat(inner)


def inputs_in(entries: Sequence[Entry]) -> Iterator[Input]:
    """Yield the inputs among them."""
    return (entry for entry in flat(entries) if isinstance(entry, Input))
