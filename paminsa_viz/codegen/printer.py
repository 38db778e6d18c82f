"""Prints formulas in another language, from their Python source.

A formula is straight-line code on numbers (`model.backend.Formula`): assignments, sums and
products, NumPy's elementwise functions, `robot.where`, named tuples, and calls of other formulas.
What is printed keeps the order of every operation, so that it gives the same bits as NumPy. What
has no counterpart raises `NotPrintable`. What differs between languages is in a `Language`.
"""

from __future__ import annotations

import ast
import re
from collections import Counter
from collections.abc import Callable, Hashable
from types import FunctionType
from typing import Any, Protocol

import numpy as np

from paminsa_viz.codegen.source import (
    INDEX,
    REAL,
    TRUTH,
    Kind,
    NotPrintable,
    Record,
    Source,
    is_record,
    read_record,
    read_source,
)
from paminsa_viz.model.robot import where

Expression = tuple[str, Kind, int]
"""Text, kind, and precedence of the outermost operation."""

ATOM, UNARY, PRODUCT, SUM, COMPARISON, AND, OR, CHOICE = 9, 8, 7, 6, 5, 4, 3, 2

FUNCTIONS: dict[Any, str] = {
    np.sqrt: "sqrt", np.abs: "fabs", np.cos: "cos", np.sin: "sin", np.arccos: "acos",
    np.arctan2: "atan2", np.tanh: "tanh", np.hypot: "hypot", np.mod: "mod",
    np.maximum: "fmax",
}  # fmt: skip
"""NumPy's functions that formulas may call, and their names in C."""

_OPERATORS = {
    ast.Add: ("+", SUM), ast.Sub: ("-", SUM), ast.Mult: ("*", PRODUCT), ast.Div: ("/", PRODUCT),
    ast.BitAnd: ("&&", AND), ast.BitOr: ("||", OR),
}  # fmt: skip

_COMPARISONS = {
    ast.Lt: "<", ast.LtE: "<=", ast.Gt: ">", ast.GtE: ">=", ast.Eq: "==", ast.NotEq: "!=",
}  # fmt: skip


class Language(Protocol):
    """What differs between the languages."""

    def function_name(self, name: str) -> str:
        """Return the name of a formula."""
        ...

    def constant_name(self, name: str) -> str:
        """Return the name of a constant of a module."""
        ...

    def type_name(self, kind: Kind) -> str:
        """Return the name of a type."""
        ...

    def number(self, value: float) -> str:
        """Return a literal."""
        ...

    def elementary(self, name: str) -> str:
        """Return an elementary function by its name in C."""
        ...

    def equality(self, operator: str) -> str:
        """Return ``==`` or ``!=`` as the language writes it."""
        ...

    def declared(self, name: str, kind: Kind, value: str, constant: bool) -> str:
        """Return the statement that declares a variable."""
        ...

    def member(self, text: str, record: Record, index: int, is_argument: bool) -> str:
        """Return one value of a record."""
        ...

    def passed(self, text: str, kind: Kind, is_argument: bool) -> str:
        """Return a variable as an argument of a call."""
        ...

    def made(self, name: str, record: Record, values: list[str]) -> tuple[list[str], str]:
        """Return statements that make a new record, and the expression for it.

        Args:
            name: That of a variable for it, if the language needs one.
            record, values: Its type, and what is in it.
        """
        ...

    def constant(self, name: str, value: Any) -> str:
        """Return the definition of a constant, a number or a tuple of numbers."""
        ...

    def type_definition(self, record: Record) -> str:
        """Return the definition of a record's type; empty where none is needed."""
        ...

    def definition(
        self, name: str, doc: str, arguments: list[tuple[str, Kind]], result: Kind, body: list[str]
    ) -> str:
        """Return a whole function."""
        ...


class Printer:
    """Prints formulas and all that they call, each once, callees first.

    Attributes:
        constants, types, functions: What was printed, by its Python name.
        results: The kind that each function returns, by its Python name.
    """

    def __init__(self, language: Language) -> None:
        self.language = language
        self.constants: dict[str, str] = {}
        self.types: dict[str, str] = {}
        self.functions: dict[str, str] = {}
        self.results: dict[str, Kind] = {}
        self._records: dict[str, Record] = {}
        self._seen: dict[FunctionType, str] = {}

    def add(self, *formulas: Callable[..., Any]) -> None:
        """Print formulas and what they need.

        Raises:
            NotPrintable: If something in them has no counterpart.
        """
        for formula in formulas:
            assert isinstance(formula, FunctionType)
            self.call(formula)

    def text(self) -> str:
        """Return everything that was printed."""
        constants = ["\n".join(self.constants.values())] if self.constants else []
        types = [text for text in self.types.values() if text]
        text = "\n\n".join([*constants, *types, *self.functions.values()]) + "\n"
        return re.sub(r"`_?([\w.]+)`", lambda found: self._mentioned(found[1]), text)

    def _mentioned(self, name: str) -> str:
        """Return what a name of a comment is called in the printed text."""
        if name in self.functions:
            return self.language.function_name(name)
        if name in self.constants:
            return self.language.constant_name(name)
        if name in self._records:
            return self.language.type_name(self._records[name])
        return name

    def call(self, function: FunctionType) -> str:
        """Return the Python name under which a function is printed, after printing it."""
        if function not in self._seen:
            name = function.__name__.lstrip("_")
            if name in self._seen.values():
                raise NotPrintable(name, 0, "a second formula of the same name")
            self._seen[function] = name
            printed, kind = _Body(self, read_source(function)).printed(name)
            self.functions[name], self.results[name] = printed, kind
        return self._seen[function]

    def record(self, kind: type) -> Record:
        """Return the record of a named tuple, after printing its type."""
        if kind.__name__ not in self._records:
            self.define(read_record(kind))
        return self._records[kind.__name__]

    def define(self, record: Record) -> Record:
        """Print the type of a record."""
        self._records[record.name] = record
        self.types[record.name] = self.language.type_definition(record)
        return record

    def constant(self, name: str, value: Any) -> str:
        """Return the name of a constant, after printing it."""
        if name not in self.constants:
            self.constants[name] = self.language.constant(name, value)
        return self.language.constant_name(name)


class _Body:
    """Prints one function."""

    def __init__(self, printer: Printer, source: Source) -> None:
        self.printer, self.source, self.language = printer, source, printer.language
        self.kinds: dict[str, Kind] = {}
        self.arguments: list[str] = []
        self.lines: list[str] = []
        self.result: Kind | None = None
        stored = [
            node.id
            for node in ast.walk(source.tree)
            if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store)
        ]
        self.changing = {name for name, count in Counter(stored).items() if count > 1}
        self._said = source.tree.body[0].lineno

    def printed(self, name: str) -> tuple[str, Kind]:
        """Return the text of the function, and what it returns."""
        tree = self.source.tree
        for argument in tree.args.args:
            self.kinds[argument.arg] = self._annotated(argument.annotation)
            self.arguments.append(argument.arg)
        self.name = name
        for number, statement in enumerate(tree.body):
            is_doc = isinstance(statement, ast.Expr) and isinstance(statement.value, ast.Constant)
            if not (number == 0 and is_doc):
                self._statement(statement)
        if self.result is None:
            raise self._refused(tree, "a function without a result")
        arguments = [(name, self.kinds[name]) for name in self.arguments]
        doc = self.source.doc
        text = self.language.definition(name, doc, arguments, self.result, self.lines)
        return text, self.result

    def _refused(self, node: ast.AST, what: str) -> NotPrintable:
        function = self.source.function
        first = function.__code__.co_firstlineno
        return NotPrintable(function.__name__, first + getattr(node, "lineno", 1) - 1, what)

    def _annotated(self, annotation: ast.expr | None) -> Kind:
        if isinstance(annotation, ast.Name):
            value = self.source.names.get(annotation.id)
            if is_record(value):
                return self.printer.record(value)
            if annotation.id == "int":
                return INDEX
        return REAL

    def _statement(self, node: ast.stmt) -> None:
        for line in range(self._said + 1, (node.end_lineno or node.lineno) + 1):
            if line in self.source.comments:
                self.lines.append(f"// {self.source.comments[line]}")
        self._said = node.end_lineno or node.lineno
        if isinstance(node, ast.Return) and node.value is not None:
            text, self.result, _ = self._returned(node.value)
            self.lines.append(f"return {text};")
        elif isinstance(node, ast.Assign) and len(node.targets) == 1:
            self._assign(node.targets[0], node.value)
        elif isinstance(node, ast.AnnAssign) and node.value is not None:
            self._assign(node.target, node.value)
        else:
            raise self._refused(node, f"the statement {type(node).__name__}")

    def _returned(self, node: ast.expr) -> Expression:
        if not isinstance(node, ast.Tuple):
            return self._expression(node)
        values = [self._real(item) for item in node.elts]
        named = all(isinstance(item, ast.Name) for item in node.elts)
        fields = tuple(item.id for item in node.elts if isinstance(item, ast.Name)) if named else ()
        doc = f"What `{self.name}` returns."
        record = self.printer.define(Record(self.name, fields, len(values), doc=doc))
        return self._made(record, values)

    def _made(self, record: Record, values: list[str]) -> Expression:
        statements, text = self.language.made(self._free_name("result"), record, values)
        self.lines += statements
        if statements:
            self.kinds[text] = record
        return text, record, ATOM

    def _assign(self, target: ast.expr, value: ast.expr) -> None:
        if isinstance(target, ast.Name):
            text, kind, _ = self._expression(value)
            self._store(target.id, kind, text)
            return
        if not isinstance(target, ast.Tuple) or not all(
            isinstance(item, ast.Name) for item in target.elts
        ):
            raise self._refused(target, "an assignment to anything but names")
        names = [item.id for item in target.elts if isinstance(item, ast.Name)]
        if isinstance(value, ast.Tuple):
            for number, item in enumerate(value.elts):
                used = {n.id for n in ast.walk(item) if isinstance(n, ast.Name)}
                if used & set(names[:number]):
                    raise self._refused(value, "an exchange of names")
            for name, item in zip(names, value.elts, strict=True):
                text, kind, _ = self._expression(item)
                self._store(name, kind, text)
            return
        text, kind = self._named(value)
        if not isinstance(kind, Record):
            raise self._refused(value, "the parts of a number")
        for index, name in enumerate(names):
            if name != "_":
                self._store(name, REAL, self._member(text, kind, index))

    def _store(self, name: str, kind: Kind, text: str) -> None:
        if name in self.kinds:
            self.lines.append(f"{name} = {text};")
            return
        self.kinds[name] = kind
        self.lines.append(self.language.declared(name, kind, text, name not in self.changing))

    def _named(self, node: ast.expr) -> tuple[str, Kind]:
        """Return the variable that holds a value; one is declared unless there is one."""
        text, kind, _ = self._expression(node)
        if isinstance(node, ast.Name) or not isinstance(kind, Record):
            return text, kind
        stem = kind.name[0].lower() + kind.name[1:]
        stem = "".join(f"_{letter.lower()}" if letter.isupper() else letter for letter in stem)
        name = self._free_name(stem)
        self._store(name, kind, text)
        return name, kind

    def _free_name(self, stem: str) -> str:
        """Return a name that no variable has."""
        name, number = stem, 1
        while name in self.kinds:
            number += 1
            name = f"{stem}_{number}"
        return name

    def _member(self, text: str, record: Record, index: int) -> str:
        return self.language.member(text, record, index, text in self.arguments)

    def _real(self, node: ast.expr) -> str:
        text, kind, _ = self._expression(node)
        if isinstance(kind, Record):
            raise self._refused(node, "a record among numbers")
        return text

    def _expression(self, node: ast.expr) -> Expression:
        match node:
            case ast.Constant(value=bool()):
                raise self._refused(node, "a truth value")
            case ast.Constant(value=int() | float() as value):
                return self.language.number(float(value)), REAL, ATOM
            case ast.Name(id=name):
                if name in self.kinds:
                    return name, self.kinds[name], ATOM
                return self._global(node, name, self.source.names.get(name))
            case ast.Attribute(value=ast.Name(id="np"), attr=name):
                value = getattr(np, name)
                if isinstance(value, float):
                    return self.language.number(value), REAL, ATOM
            case ast.Attribute(value=inner, attr=name):
                text, kind = self._named(inner)
                if isinstance(kind, Record) and name in kind.fields:
                    return self._member(text, kind, kind.fields.index(name)), REAL, ATOM
            case ast.Subscript(value=ast.Name(id=name), slice=index) if name not in self.kinds:
                value = self.source.names.get(name)
                if isinstance(value, tuple):
                    place = index.value if isinstance(index, ast.Constant) else self._real(index)
                    return f"{self.printer.constant(name, value)}[{place}]", REAL, ATOM
            case ast.Subscript(value=inner, slice=ast.Constant(value=int() as index)):
                text, kind = self._named(inner)
                if isinstance(kind, Record):
                    return self._member(text, kind, index), REAL, ATOM
            case ast.UnaryOp(op=ast.USub(), operand=operand):
                return f"-{self._operand(operand, UNARY + 1)}", REAL, UNARY
            case ast.BinOp(left=left, op=op, right=right) if type(op) in _OPERATORS:
                sign, level = _OPERATORS[type(op)]
                kind = TRUTH if level in (AND, OR) else REAL
                least = COMPARISON if kind is TRUTH else level
                first = self._operand(left, least, same=sign)
                second = self._operand(right, COMPARISON if kind is TRUTH else level + 1)
                return f"{first} {sign} {second}", kind, level
            case ast.Compare(left=left, ops=[op], comparators=[right]) if type(op) in _COMPARISONS:
                sign = _COMPARISONS[type(op)]
                if sign in ("==", "!="):
                    sign = self.language.equality(sign)
                first = self._operand(left, COMPARISON + 1)
                second = self._operand(right, COMPARISON + 1)
                return f"{first} {sign} {second}", TRUTH, COMPARISON
            case ast.Call(func=function, args=arguments, keywords=[]):
                return self._call(node, self._function(function), arguments)
        raise self._refused(node, f"the expression {ast.unparse(node)[:60]}")

    def _operand(self, node: ast.expr, least: int, same: str = "") -> str:
        """Return an operand, in parentheses unless it binds at least as tightly."""
        text, kind, level = self._expression(node)
        if isinstance(kind, Record):
            raise self._refused(node, "a record among numbers")
        repeats = isinstance(node, ast.BinOp) and _OPERATORS.get(type(node.op), ("",))[0] == same
        return text if level >= least or (repeats and same) else f"({text})"

    def _global(self, node: ast.expr, name: str, value: Any) -> Expression:
        if isinstance(value, (int, float)):
            return self.printer.constant(name, float(value)), REAL, ATOM
        raise self._refused(node, f"the name {name}")

    def _function(self, node: ast.expr) -> Any:
        match node:
            case ast.Attribute(value=ast.Name(id=module), attr=name):
                return getattr(self.source.names.get(module), name, None)
            case ast.Name(id=name):
                return self.source.names.get(name)
        return None

    def _call(self, node: ast.Call, function: Any, arguments: list[ast.expr]) -> Expression:
        if function is where:
            condition, yes, no = (self._operand(item, CHOICE + 1) for item in arguments)
            return f"{condition} ? {yes} : {no}", self._expression(arguments[1])[1], CHOICE
        if isinstance(function, Hashable) and function in FUNCTIONS:
            values = ", ".join(self._real(item) for item in arguments)
            return f"{self.language.elementary(FUNCTIONS[function])}({values})", REAL, ATOM
        if is_record(function):
            record = self.printer.record(function)
            if len(arguments) == record.size:
                values = [self._real(item) for item in arguments]
                return self._made(record, values)
        if isinstance(function, FunctionType):
            name = self.printer.call(function)
            passed = []
            for item in arguments:
                if isinstance(item, ast.Constant) and isinstance(item.value, int):
                    passed.append(str(item.value))
                    continue
                text, kind, _ = self._expression(item)
                if isinstance(kind, Record):
                    text, kind = self._named(item)
                passed.append(self.language.passed(text, kind, text in self.arguments))
            called = f"{self.language.function_name(name)}({', '.join(passed)})"
            return called, self.printer.results[name], ATOM
        raise self._refused(node, f"a call of {ast.unparse(node.func)}")


def filled(text: str, indent: int, at: str = " ", width: int = 100) -> list[str]:
    """Return a statement as lines no longer than a width, where it can be broken ``at`` a text."""
    lines: list[str] = []
    line = " " * indent
    words = text.split(at)
    for number, word in enumerate(words):
        part = word + at.rstrip() * (number < len(words) - 1)
        longer = f"{line} {part}" if line.strip() else line + part
        if len(longer) > width and line.strip():
            lines.append(line)
            line = " " * (indent + 4) + part
        else:
            line = longer
    return [*lines, line]


def commented(doc: str) -> list[str]:
    """Return a docstring as a comment; names in single backticks are for `Printer.text`."""
    lines = [line.replace("``", "").rstrip() for line in doc.split("\n")]
    if len(lines) == 1:
        return [f"/* {lines[0]} */"]
    return [f"/* {lines[0]}", *(f" * {line}".rstrip() for line in lines[1:]), " */"]
