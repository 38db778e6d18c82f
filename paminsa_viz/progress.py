"""How long work says how far it is, and how it is ended."""

from __future__ import annotations

from typing import Any, Protocol

__all__ = ["Canceled", "Progress", "go_on", "keep_on", "of_part"]


class Progress(Protocol):
    """Called now and then by work that takes long; returns whether to end it.

    Args:
        done: What part is done, 0 to 1.
        known: What else is known by then; each function says what it tells.
    """

    def __call__(self, done: float, /, **known: Any) -> bool | None: ...


class Canceled(Exception):
    """Work that its progress function ended, where there is no result yet to return."""


def go_on(done: float, /, **known: Any) -> bool:
    """Take no notice, and do not end the work."""
    return False


def keep_on(progress: Progress, done: float, /, **known: Any) -> None:
    """Tell how far work is.

    Raises:
        Canceled: If the progress function ends it.
    """
    if progress(done, **known):
        raise Canceled


def of_part(progress: Progress, begin: float, end: float) -> Progress:
    """Return the progress of a part of work: from begin to end, of 0 to 1, of the whole."""

    def tell(done: float, /, **known: Any) -> bool | None:
        return progress(begin + (end - begin) * done, **known)

    return tell
