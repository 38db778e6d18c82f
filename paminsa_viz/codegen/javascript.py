"""Formulas in JavaScript: records are objects, tuples without names are arrays."""

from __future__ import annotations

import math
from typing import Any

from paminsa_viz.codegen.printer import commented, filled
from paminsa_viz.codegen.source import Kind, Record


class JavaScript:
    """JavaScript as any engine of this decade reads it."""

    def function_name(self, name: str) -> str:
        """Return the name of a formula."""
        return "paminsa" + "".join(word.capitalize() for word in name.split("_"))

    def constant_name(self, name: str) -> str:
        """Return the name of a constant of a module."""
        return name

    def type_name(self, kind: Kind) -> str:
        """Return the name of a type as comments have it."""
        return kind.name

    def number(self, value: float) -> str:
        """Return a literal that reads back as the same double."""
        if math.isnan(value):
            return "NaN"
        return "Infinity" if math.isinf(value) else repr(value)

    def elementary(self, name: str) -> str:
        """Return an elementary function by its name in C."""
        if name == "mod":
            return "floorMod"
        return "Math." + {"fabs": "abs", "fmax": "max"}.get(name, name)

    def equality(self, operator: str) -> str:
        """Return ``==`` or ``!=`` as the language writes it."""
        return f"{operator}="

    def declared(self, name: str, kind: Kind, value: str, constant: bool) -> str:
        """Return the statement that declares a variable."""
        return f"{'const' if constant else 'let'} {name} = {value};"

    def member(self, text: str, record: Record, index: int, is_argument: bool) -> str:
        """Return one value of a record."""
        return f"{text}.{record.fields[index]}" if record.fields else f"{text}[{index}]"

    def passed(self, text: str, kind: Kind, is_argument: bool) -> str:
        """Return a variable as an argument of a call."""
        return text

    def made(self, name: str, record: Record, values: list[str]) -> tuple[list[str], str]:
        """Return no statement, and a literal."""
        if not record.fields:
            return [], f"[{', '.join(values)}]"
        pairs = zip(record.fields, values, strict=True)
        return [], "{ " + ", ".join(f"{name}: {value}" for name, value in pairs) + " }"

    def constant(self, name: str, value: Any) -> str:
        """Return the definition of a constant."""
        if isinstance(value, tuple):
            return f"const {name} = [{', '.join(self.number(float(item)) for item in value)}];"
        return f"const {name} = {self.number(value)};"

    def type_definition(self, record: Record) -> str:
        """Return nothing: objects need no type."""
        return ""

    def definition(
        self, name: str, doc: str, arguments: list[tuple[str, Kind]], result: Kind, body: list[str]
    ) -> str:
        """Return a whole function."""
        head = f"function {self.function_name(name)}({', '.join(a for a, _ in arguments)}) {{"
        lines = [*commented(doc), *filled(head, 0)]
        for line in body:
            lines += filled(line, 4)
        return "\n".join([*lines, "}"])


FLOOR_MOD = """\
/* Helper, not in the paper, units as of the values: the remainder with the sign of the divisor. */
function floorMod(a, b) {
    const rest = a % b;
    return rest !== 0 && (b < 0) !== (rest < 0) ? rest + b : rest;
}
"""
"""What the printed functions call besides ``Math``."""
