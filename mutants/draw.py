"""Small changes of a source file, drawn from its syntax tree.

Only the text of the node that changes is written anew, so that all else, line numbers included,
stays as it is: the loops that Numba compiles and their digests see an ordinary source file.
"""

from __future__ import annotations

import ast
import random
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

_Node = ast.expr | ast.stmt

Key = tuple[str, str, str, str, int]
"""File, line of code, before, after, and number of a mutant."""


@dataclass(frozen=True)
class Mutant:
    """A change of one node.

    Attributes:
        path: The file, below the package's root.
        line, column: Where the node begins, from 1 and 0.
        start, end: Bytes of the file that are replaced.
        before, after: Source of the node, as ``ast.unparse`` writes it.
        code: The first line of the node as it stands in the file.
        number: How many changes of the file before this one read the same.
        is_expression: Whether the node is one; it is a statement otherwise.
    """

    path: str
    line: int
    column: int
    start: int
    end: int
    before: str
    after: str
    code: str
    number: int
    is_expression: bool

    @property
    def key(self) -> Key:
        """What tells it from all others, wherever in the file it stands."""
        return self.path, self.code, self.before, self.after, self.number

    def apply(self, source: bytes) -> bytes:
        """Return the file with the change."""
        changed = f"({self.after})" if self.is_expression else self.after
        return source[: self.start] + changed.encode() + source[self.end :]


_COMPARED: dict[type[ast.cmpop], tuple[type[ast.cmpop], ...]] = {
    ast.Lt: (ast.LtE, ast.Gt),
    ast.LtE: (ast.Lt, ast.GtE),
    ast.Gt: (ast.GtE, ast.Lt),
    ast.GtE: (ast.Gt, ast.LtE),
    ast.Eq: (ast.NotEq,),
    ast.NotEq: (ast.Eq,),
    ast.Is: (ast.IsNot,),
    ast.IsNot: (ast.Is,),
    ast.In: (ast.NotIn,),
    ast.NotIn: (ast.In,),
}
_COMPUTED: dict[type[ast.operator], type[ast.operator]] = {
    ast.Add: ast.Sub,
    ast.Sub: ast.Add,
    ast.Mult: ast.Div,
    ast.Div: ast.Mult,
    ast.FloorDiv: ast.Mult,
    ast.Mod: ast.Mult,
    ast.Pow: ast.Mult,
    ast.MatMult: ast.Mult,
    ast.BitAnd: ast.BitOr,
    ast.BitOr: ast.BitAnd,
}
_PAIRS = (
    ("minimum", "maximum"), ("fmin", "fmax"), ("min", "max"), ("argmin", "argmax"),
    ("sin", "cos"), ("arcsin", "arccos"), ("any", "all"), ("floor", "ceil"),
    ("nanmin", "nanmax"), ("zeros", "ones"), ("flatnonzero", "nonzero"),
)  # fmt: skip
_OTHER_NAME = {a: b for pair in _PAIRS for a, b in (pair, pair[::-1])}
_ORDERED = {"where", "arctan2", "copysign", "cross"}
"""Functions whose last two arguments are not to be exchanged."""
_DROPPED = {"abs", "sqrt", "sorted", "cumsum", "conj", "unique", "square", "sign", "clip"}


def candidates(path: str, source: bytes) -> list[Mutant]:
    """Return every change of a file's source; ``path`` is what it is called."""
    lines = source.splitlines(keepends=True)
    starts = [0]
    for line in lines:
        starts.append(starts[-1] + len(line))
    found, tree = [], ast.parse(source)
    alike, seen = set(_alike(tree)), Counter[tuple[str, str, str]]()
    for node, others in _changes(tree):
        if node in alike:
            continue
        assert node.end_lineno is not None
        assert node.end_col_offset is not None
        start = starts[node.lineno - 1] + node.col_offset
        end = starts[node.end_lineno - 1] + node.end_col_offset
        code, before = lines[node.lineno - 1].decode().strip(), ast.unparse(node)
        for other in others:
            after = ast.unparse(other)
            if after != before:
                place, text = (
                    (path, node.lineno, node.col_offset, start, end),
                    (before, after, code),
                )
                found.append(Mutant(*place, *text, seen[text], isinstance(node, ast.expr)))
                seen[text] += 1
    return found


def drawn(root: Path, subpackage: str, seed: int, count: int) -> list[Mutant]:
    """Return so many different changes of a subpackage's files; a seed gives the same ones.

    Args:
        root: The checkout.
        subpackage: Name of a folder of the package.
        seed: Of the draw.
        count: How many; fewer if the subpackage has fewer.
    """
    every: list[Mutant] = []
    for file in sorted((root / "paminsa_viz" / subpackage).rglob("*.py")):
        every += candidates(file.relative_to(root).as_posix(), file.read_bytes())
    return random.Random(f"{subpackage} {seed}").sample(every, min(count, len(every)))


def _changes(tree: ast.AST) -> Iterator[tuple[_Node, Sequence[_Node]]]:
    """Yield expressions and statements of a tree with what each may become."""
    conditions = _conditions(tree)
    for child in _looked_into(tree):
        if isinstance(child, ast.expr):
            yield child, list(_others(child))
            if any(child is one for one in conditions):
                yield child, [ast.UnaryOp(ast.Not(), child)]
        elif isinstance(child, ast.stmt):
            yield child, list(_other_statements(child))
        yield from _changes(child)


def _conditions(node: ast.AST) -> list[ast.expr]:
    """Return the conditions of a node that have no operator, which is what changes elsewhere."""
    match node:
        case ast.If(test) | ast.comprehension(ifs=[test]):
            found = [test]
        case ast.BoolOp(_, values):
            found = values
        case _:
            found = []
    plain = ast.Name, ast.Attribute, ast.Call, ast.Subscript
    return [one for one in found if isinstance(one, plain)]


def _looked_into(node: ast.AST) -> Iterator[ast.AST]:
    """Yield the parts of a node that decide what the program does.

    Left out are annotations, decorators, imports, text (whose parts have no place in the file
    before Python 3.12), and what is for type checkers.
    """
    skipped: tuple[str, ...] = ("annotation", "returns", "decorator_list")
    if isinstance(node, ast.If) and ast.unparse(node.test) == "TYPE_CHECKING":
        return
    if isinstance(node, (ast.JoinedStr, ast.Import, ast.ImportFrom, ast.Raise)):
        return
    for name, value in ast.iter_fields(node):
        if name in skipped:
            continue
        for item in value if isinstance(value, list) else [value]:
            if isinstance(item, ast.AST):
                yield item


def _alike(tree: ast.AST) -> Iterator[ast.AST]:
    """Yield what no test can tell changed, whatever is around it.

    ``strict`` of ``zip`` is a check for mistakes in the source; for the -1 of ``reshape`` NumPy
    takes any negative number.
    """
    for call in ast.walk(tree):
        match call:
            case ast.Call(ast.Name("zip")):
                yield from (keyword.value for keyword in call.keywords)
            case ast.Call(ast.Attribute(attr="reshape")):
                for part in ast.walk(call):
                    if isinstance(part, ast.UnaryOp) and ast.unparse(part) == "-1":
                        yield part.operand


def _others(node: ast.expr) -> Iterator[ast.expr]:
    """Yield what an expression may become."""
    match node:
        case ast.Compare(left, [op], [right]):
            for other in _COMPARED[type(op)]:
                yield ast.Compare(left, [other()], [right])
        case ast.Compare(left, operators, rights):
            for i, op in enumerate(operators):
                for other in _COMPARED[type(op)]:
                    changed = [*operators[:i], other(), *operators[i + 1 :]]
                    yield ast.Compare(left, changed, rights)
        case ast.BinOp(left, op, right) if type(op) in _COMPUTED:
            yield ast.BinOp(left, _COMPUTED[type(op)](), right)
        case ast.BoolOp(op, values):
            yield ast.BoolOp(ast.Or() if isinstance(op, ast.And) else ast.And(), values)
        case ast.UnaryOp(_, operand):
            yield operand
        case ast.IfExp(test, body, orelse):
            yield ast.IfExp(test, orelse, body)
        case ast.Constant(bool() as value):
            yield ast.Constant(not value)
        case ast.Constant(int() as value):
            yield ast.Constant(value + 1)
        case ast.Constant(float() as value):
            yield ast.Constant(1.1 * value if value else 1.0)
        case ast.Call(function, arguments, keywords):
            name = function.attr if isinstance(function, ast.Attribute) else ""
            name = name or (function.id if isinstance(function, ast.Name) else "")
            if name in _OTHER_NAME:
                other = _OTHER_NAME[name]
                swapped = (
                    ast.Attribute(function.value, other, ast.Load())
                    if isinstance(function, ast.Attribute)
                    else ast.Name(other, ast.Load())
                )
                yield ast.Call(swapped, arguments, keywords)
            elif name in _DROPPED and arguments:
                yield arguments[0]
            elif name in _ORDERED and len(arguments) > 1:
                *first, a, b = arguments
                yield ast.Call(function, [*first, b, a], keywords)


def _other_statements(node: ast.stmt) -> Iterator[ast.stmt]:
    """Yield what a statement may become: a sum the other way, or nothing at all."""
    match node:
        case ast.AugAssign(target, op, value):
            if type(op) in _COMPUTED:
                yield ast.AugAssign(target, _COMPUTED[type(op)](), value)
            yield ast.Pass()
        case ast.Expr(ast.Call()) | ast.Continue():
            yield ast.Pass()
        case ast.Assign(targets=[ast.Subscript() | ast.Attribute()]):
            yield ast.Pass()
