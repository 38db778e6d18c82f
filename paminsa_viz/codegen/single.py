"""C in double precision turned into C in single precision."""

from __future__ import annotations

import re

from paminsa_viz.codegen.printer import FUNCTIONS

ROUNDING = 2.0**-19
"""Of singularities, 16 units of the last place of a float; see `model.leg.ROUNDING`."""

_LITERAL = re.compile(r"(?<![\w.])((?:\d+\.\d*|\.\d+)(?:[eE][+-]?\d+)?|\d+[eE][+-]?\d+)(?![\w.])")
_CALLS = re.compile(rf"\b({'|'.join(sorted(set(FUNCTIONS.values()) | {'fmod'}))})\(")
_KEPT = re.compile(r"(/\*.*?\*/|\"[^\"\n]*\"|#include[^\n]*|strtod|\(double\))", re.DOTALL)


def single_precision(text: str) -> str:
    """Return C source with float for double, in types, functions and literals; comments stay."""
    parts = _KEPT.split(text)
    for index in range(0, len(parts), 2):
        part = re.sub(r"(#define PAMINSA_ROUNDING) \S+", rf"\1 {ROUNDING!r}", parts[index])
        part = re.sub(r"\bdouble\b", "float", part)
        parts[index] = _LITERAL.sub(r"\1f", _CALLS.sub(r"\1f(", part))
    return "".join(parts)
