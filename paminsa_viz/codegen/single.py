"""C in double precision turned into C in single precision."""

from __future__ import annotations

import re

from paminsa_viz.codegen.printer import FUNCTIONS

TOLERANCES = {"ROUNDING": 2.0**-19, "SINGULAR": 2.0**-11}
"""`model.leg.ROUNDING` and `SINGULAR`, by as much larger as the last place of a float is."""

_LITERAL = re.compile(r"(?<![\w.])((?:\d+\.\d*|\.\d+)(?:[eE][+-]?\d+)?|\d+[eE][+-]?\d+)(?![\w.])")
_CALLS = re.compile(rf"\b({'|'.join(sorted(set(FUNCTIONS.values()) | {'fmod'}))})\(")
_KEPT = re.compile(r"(/\*.*?\*/|\"[^\"\n]*\"|#include[^\n]*|strtod|\(double\))", re.DOTALL)


def single_precision(text: str) -> str:
    """Return C source with float for double, in types, functions and literals; comments stay."""
    parts = _KEPT.split(text)
    for index in range(0, len(parts), 2):
        part = parts[index]
        for name, value in TOLERANCES.items():
            part = re.sub(rf"(#define PAMINSA_{name}) \S+", rf"\1 {value!r}", part)
        part = re.sub(r"\bdouble\b", "float", part)
        parts[index] = _LITERAL.sub(r"\1f", _CALLS.sub(r"\1f(", part))
    return "".join(parts)
