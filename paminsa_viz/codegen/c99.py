"""Formulas in C99 that is C++11 too: structs by pointer in, by value out; only math.h is needed."""

from __future__ import annotations

import math
from typing import Any

from paminsa_viz.codegen.printer import commented, filled
from paminsa_viz.codegen.source import INDEX, TRUTH, Kind, Record


class C99:
    """C99 with every name behind a prefix."""

    def function_name(self, name: str) -> str:
        """Return the name of a formula."""
        return f"paminsa_{name}"

    def constant_name(self, name: str) -> str:
        """Return the name of a constant of a module."""
        return f"PAMINSA_{name}"

    def type_name(self, kind: Kind) -> str:
        """Return the name of a type."""
        if isinstance(kind, Record):
            return "Paminsa" + "".join(w[0].upper() + w[1:] for w in kind.name.split("_"))
        return {INDEX: "int", TRUTH: "int"}.get(kind, "double")

    def number(self, value: float) -> str:
        """Return a literal that reads back as the same double."""
        if math.isnan(value):
            return "NAN"
        return "INFINITY" if math.isinf(value) else repr(value)

    def elementary(self, name: str) -> str:
        """Return an elementary function by its name in C."""
        return "paminsa_mod" if name == "mod" else name

    def equality(self, operator: str) -> str:
        """Return ``==`` or ``!=`` as the language writes it."""
        return operator

    def declared(self, name: str, kind: Kind, value: str, constant: bool) -> str:
        """Return the statement that declares a variable."""
        return f"{'const ' * constant}{self.type_name(kind)} {name} = {value};"

    def member(self, text: str, record: Record, index: int, is_argument: bool) -> str:
        """Return one value of a record."""
        name = record.fields[index] if record.fields else f"values[{index}]"
        return f"{text}{'->' if is_argument else '.'}{name}"

    def passed(self, text: str, kind: Kind, is_argument: bool) -> str:
        """Return a variable as an argument of a call: records by their address."""
        return f"&{text}" if isinstance(kind, Record) and not is_argument else text

    def made(self, name: str, record: Record, values: list[str]) -> tuple[list[str], str]:
        """Return what declares and fills a variable, and its name.

        C99's literals of structs are not in C++, nor are names in initializers before C++20.
        """
        if not record.fields:
            inside = ", ".join(values)
            return [f"const {self.type_name(record)} {name} = {{{{{inside}}}}};"], name
        pairs = zip(record.fields, values, strict=True)
        filling = [f"{name}.{field} = {value};" for field, value in pairs]
        return [f"{self.type_name(record)} {name};", *filling], name

    def constant(self, name: str, value: Any) -> str:
        """Return the definition of a constant."""
        if isinstance(value, tuple):
            inside = ", ".join(self.number(float(item)) for item in value)
            return f"static const double {self.constant_name(name)}[{len(value)}] = {{{inside}}};"
        return f"#define {self.constant_name(name)} {self.number(value)}"

    def type_definition(self, record: Record) -> str:
        """Return the definition of a struct."""
        lines = commented(record.doc) if record.doc else []
        lines.append("typedef struct {")
        if not record.fields:
            lines.append(f"    double values[{record.size}];")
        comments = record.comments or ("",) * len(record.fields)
        for name, comment in zip(record.fields, comments, strict=True):
            lines.append(f"    double {name};" + (f"  /* {comment} */" if comment else ""))
        return "\n".join([*lines, f"}} {self.type_name(record)};"])

    def definition(
        self, name: str, doc: str, arguments: list[tuple[str, Kind]], result: Kind, body: list[str]
    ) -> str:
        """Return a whole function."""
        given = ", ".join(
            f"const {self.type_name(kind)} *{argument}"
            if isinstance(kind, Record)
            else f"{self.type_name(kind)} {argument}"
            for argument, kind in arguments
        )
        head = f"static inline {self.type_name(result)} {self.function_name(name)}({given})"
        lines = [*commented(doc), *filled(head, 0, ", "), "{"]
        words = set("\n".join(body).replace(".", " .").translate(_BREAKS).split())
        lines += [f"    (void){a};" for a, _ in arguments if a not in words]
        for line in body:
            if line.startswith("// "):
                lines += filled(f"/* {line[3:]} */", 4)
            else:
                lines += filled(line, 4)
        return "\n".join([*lines, "}"])


_BREAKS = str.maketrans(dict.fromkeys("()[]{}+-*/,;&|<>=!?:", " "))
