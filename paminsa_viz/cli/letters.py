"""Letters that a terminal or a file of the system's code page lacks, as those that it has."""

from __future__ import annotations

import codecs
import sys

SPELLED = "paminsa_viz.spelled"
"""Name of the way to encode a text that has such letters, for ``errors`` of a stream."""


def as_written(text: str) -> str:
    """Return a text as the output will have it, to know its length."""
    encoding = getattr(sys.stdout, "encoding", None) or "utf-8"
    return text.encode(encoding, SPELLED).decode(encoding)


def spell_letters(error: UnicodeError) -> tuple[str, int]:
    """Return what is written instead of letters, and where the text goes on: ``1/kappa``, ``N_1``.

    Raises:
        UnicodeError: The error itself if it is not one of writing.
    """
    if not isinstance(error, UnicodeEncodeError):
        raise error
    written, before = "", ""
    for letter in error.object[error.start : error.end]:
        mark, plain = _spelled(letter)
        written += plain if mark == before else mark + plain  # one for a number of several digits
        before = mark
    return written, error.end


def _spelled(letter: str) -> tuple[str, str]:
    """Return the mark of a raised or lowered letter, or nothing, and what is written for it."""
    import unicodedata  # late: most output needs none of it

    kind, _, name = unicodedata.name(letter, "").partition(" LETTER ")
    if kind in ("GREEK SMALL", "GREEK CAPITAL"):
        return "", name.lower() if kind == "GREEK SMALL" else name.capitalize()
    whole = unicodedata.normalize("NFKD", letter).replace("\N{MINUS SIGN}", "-")
    plain = whole.encode("ascii", "ignore").decode()
    if not plain:
        return "", "-" if unicodedata.category(letter) == "Pd" else "?"
    kind = unicodedata.decomposition(letter).partition(" ")[0]
    return {"<sub>": "_", "<super>": "^"}.get(kind, ""), plain


codecs.register_error(SPELLED, spell_letters)
