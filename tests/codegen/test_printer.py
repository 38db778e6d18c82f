"""What is printed of the formulas gives the same bits as NumPy, in C and in JavaScript."""

from __future__ import annotations

import inspect
import itertools
import shutil
import subprocess
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pytest

from paminsa_viz.codegen.c99 import C99
from paminsa_viz.codegen.javascript import JavaScript
from paminsa_viz.codegen.printer import Printer, filled
from paminsa_viz.codegen.source import NotPrintable
from paminsa_viz.model.leg import Mechanism
from paminsa_viz.model.robot import where
from tests.codegen.printed import (
    EXACT,
    ROUNDED,
    SANITIZERS,
    c_program,
    columns,
    compilers,
    js_program,
    on_numpy,
    registered,
    run_c,
    sanitizes,
    table,
)

STATES = 20_000


def run_js(folder: Path, program: str, rows: np.ndarray) -> np.ndarray:
    """Run a program in Node and return its output for rows of numbers."""
    (folder / "rows").write_bytes(rows.tobytes())
    (folder / "program.js").write_text(program)
    subprocess.run(["node", "program.js", "rows", "out"], cwd=folder, check=True)
    return np.frombuffer((folder / "out").read_bytes())


def same_bits(got: np.ndarray, wanted: np.ndarray) -> np.ndarray:
    """Whether numbers are equal, all NaN being one, elementwise."""
    return (got == wanted) & (np.signbit(got) == np.signbit(wanted)) | np.isnan(got) & np.isnan(
        wanted
    )


@pytest.mark.slow
def test_every_registered_formula_prints_in_both_languages() -> None:
    formulas = list(registered())
    assert len(formulas) >= 7
    for language in (C99(), JavaScript()):
        printer = Printer(language)
        printer.add(*formulas)
        assert {formula.__name__ for formula in formulas} <= set(printer.functions)
        lines = printer.text().splitlines()
        assert max(map(len, lines)) <= 100
        heads = [line for line in lines if line.lstrip().startswith(("function ", "static inline"))]
        assert len(heads) == len(printer.functions)
        assert not any(line.startswith(" ") for line in heads)


@pytest.mark.slow
@pytest.mark.parametrize("compiler", compilers())
def test_c_has_the_bits_of_numpy(compiler: str, tmp_path: Path) -> None:
    given = columns(STATES)
    program, width = c_program(EXACT, given)
    rows = table(given)
    got = np.frombuffer(run_c(tmp_path, program, compiler, rows, "-O2")).reshape(-1, width)
    wanted = on_numpy(EXACT, given)
    assert got.shape == wanted.shape == (STATES, width)
    assert same_bits(got, wanted).all()
    assert np.isfinite(wanted).all(axis=1).mean() > 0.2


@pytest.mark.slow
@pytest.mark.skipif(shutil.which("node") is None, reason="no node here")
def test_javascript_has_the_bits_of_numpy(tmp_path: Path) -> None:
    given = columns(STATES)
    program, width = js_program(EXACT, given)
    got = run_js(tmp_path, program, table(given)).reshape(-1, width)
    assert same_bits(got, on_numpy(EXACT, given)).all()


@pytest.mark.slow
def test_formulas_with_angles_differ_by_rounding_only(tmp_path: Path) -> None:
    given = columns(1000)
    program, width = c_program(ROUNDED, given)
    got = np.frombuffer(run_c(tmp_path, program, "gcc", table(given))).reshape(-1, width)
    np.testing.assert_allclose(got, on_numpy(ROUNDED, given), rtol=1e-11, atol=1e-14)


@pytest.mark.slow
@pytest.mark.parametrize("compiler", compilers())
def test_sanitizers_find_nothing_on_any_number(compiler: str, tmp_path: Path) -> None:
    if not sanitizes(compiler, tmp_path):
        pytest.skip(f"{compiler} has no sanitizers here")
    formulas = EXACT + ROUNDED
    given = columns(300)
    program, width = c_program(formulas, given)
    rows = table(given)
    rng = np.random.default_rng(3)
    odd = rng.choice([np.nan, np.inf, -np.inf, 0.0, -0.0, 1e308, 5e-324], rows.shape)
    rows = np.where(rng.random(rows.shape) < 0.05, odd, rows)
    assert len(run_c(tmp_path, program, compiler, rows, *SANITIZERS)) == 8 * width * len(rows)


def loop(m: Mechanism, x: Any) -> Any:
    """A formula with a loop."""
    for _ in range(3):
        x = x * m.k
    return x


def swapped(m: Mechanism, x: Any, y: Any) -> Any:
    """A formula that exchanges two names."""
    x, y = y, x
    return x - y


def indexed(m: Mechanism, x: Any) -> Any:
    """A formula that assigns to a name and to a place at once."""
    y, x[0] = x, x
    return y


def power(m: Mechanism, x: Any) -> Any:
    """A formula with an operator that languages round differently."""
    return x**3


def said_twice(m: Mechanism, x: Any) -> Any:
    """A formula with a description."""
    """And another one, which would be none of C."""
    return x * m.k


@pytest.mark.parametrize(
    ("formula", "words"),
    [
        (loop, "the statement For"),
        (said_twice, "the statement Expr"),
        (swapped, "an exchange of names"),
        (indexed, "an assignment to anything but names"),
        (power, "x ** 3"),
    ],
)
def test_what_has_no_counterpart_is_refused_with_its_place(formula: Any, words: str) -> None:
    with pytest.raises(NotPrintable, match=rf"{formula.__name__}, line \d+: .*") as caught:
        Printer(C99()).add(formula)
    assert words in str(caught.value)
    first = inspect.getsourcelines(formula)[1]
    assert f", line {first + 2}: " in str(caught.value)  # below its head and description


def undescribed(m: Mechanism, x: Any) -> Any:
    y = x * m.k
    return y + 1.0


def test_a_formula_without_a_description_is_printed_from_its_first_statement_on() -> None:
    printer = Printer(C99())
    printer.add(undescribed)
    text = printer.text()
    assert "double y = x * m->k;" in text
    assert "return y + 1.0;" in text


def either(a: Any, b: Any, d: Any) -> Any:
    """A choice between truths is one, and between numbers a number."""
    is_less = where(a < b, b < d, d < a)
    less = where(is_less, a, b)
    return less * d


def test_a_choice_is_of_the_kind_of_what_it_chooses_from() -> None:
    lines = printed(C99(), either)["either"]
    assert "const int is_less = a < b ? b < d : d < a;" in lines
    assert "const double less = is_less ? a : b;" in lines


class Pair(NamedTuple):
    """Two numbers."""

    first: Any  # of the left side [m]
    second: Any
    third: Any


def explained(p: Pair, a: Any) -> Any:  # which is of no statement
    """A formula with comments."""
    # before the first
    x = p.first * a  # beside it
    # before the second
    y = where(
        x < a,  # within
        x,  # the one
        a,
    )
    # type: nothing to be said
    return y + p.third


def test_comments_are_printed_where_they_stand_and_those_for_tools_are_not() -> None:
    printer = Printer(C99())
    printer.add(explained)
    lines = printer.text().splitlines()
    assert "    double first;  /* of the left side [m] */" in lines
    assert "    double second;" in lines
    assert "    double third;" in lines
    body = lines[lines.index("{") + 1 :]
    assert body[:-1] == [
        "    /* before the first */",
        "    /* beside it */",
        "    const double x = p->first * a;",
        "    /* before the second */",
        "    /* within */",
        "    /* the one */",
        "    const double y = x < a ? x : a;",
        "    return y + p->third;",
    ]
    assert "/* Two numbers. */" in lines
    assert "/* A formula with comments. */" in lines


def arithmetic(a: Any, b: Any, d: Any) -> Any:
    """Python, C and JavaScript need the same parentheses here."""
    x = a - b - d + a * b / d * -a
    y = -(a + b) * (x - d) / (a * b) - -b
    z = x / y - (x - y) + -(x * y)
    return z / -x


def conditions(a: Any, b: Any, d: Any) -> Any:
    """Conditions with the parentheses that compilers want, and no others."""
    x = where((a < b) & (a - b < d) & (d < a + b), -a, a + b)
    y = where((a < b) | (b < d) | (d < a), b - a, d)
    z = where((a < b) | (b < d) & (d < a), where(a < b, d, a), x * y)
    return where((a < b) == (a + b < d), x, z)


def parts(a: Any, b: Any) -> Any:
    """Two numbers with names."""
    total = a + b
    rest = a - b
    return total, rest


def halves(a: Any) -> Any:
    """Two numbers without."""
    return a / 2, -a / 2


class BothEnds(NamedTuple):
    """Two ends, see `halves`."""

    near: Any
    far: Any


def ends(a: Any) -> BothEnds:
    """Two numbers of a kind, a `BothEnds`."""
    return BothEnds(a, -a)


def composed(a: Any, b: Any) -> Any:
    """What reads them."""
    total, rest = parts(a, b)
    _, half = parts(rest, total)
    first, second = halves(half)
    near, far = ends(first)
    return near * second - ends(far).near


def printed(language: Any, *formulas: Any) -> dict[str, list[str]]:
    """Return the lines of the functions of a language, without their indent."""
    printer = Printer(language)
    printer.add(*formulas)
    return {
        name: [line.strip() for line in text.splitlines()]
        for name, text in printer.functions.items()
    }


def test_there_are_no_needless_parentheses() -> None:
    source = [line.strip() for line in inspect.getsource(arithmetic).splitlines()[2:]]
    for language, start in ((C99(), "const double "), (JavaScript(), "const ")):
        functions = printed(language, arithmetic, conditions)
        lines = [line.removeprefix(start) for line in functions["arithmetic"][-5:-1]]
        assert lines == [f"{line};" for line in source]
        equal = language.equality("==")
        assert [line.removeprefix(start) for line in functions["conditions"][-5:-1]] == [
            "x = a < b && a - b < d && d < a + b ? -a : a + b;",
            "y = a < b || b < d || d < a ? b - a : d;",
            "z = a < b || (b < d && d < a) ? (a < b ? d : a) : x * y;",
            f"return (a < b) {equal} (a + b < d) ? x : z;",
        ]


WRITTEN = {
    C99: """\
/* What paminsa_parts returns. */
typedef struct {
    double total;
    double rest;
} PaminsaParts;

/* What paminsa_halves returns. */
typedef struct {
    double values[2];
} PaminsaHalves;

/* Two ends, see paminsa_halves. */
typedef struct {
    double near;
    double far;
} PaminsaBothEnds;

/* Two numbers with names. */
static inline PaminsaParts paminsa_parts(double a, double b)
{
    const double total = a + b;
    const double rest = a - b;
    PaminsaParts result;
    result.total = total;
    result.rest = rest;
    return result;
}

/* Two numbers without. */
static inline PaminsaHalves paminsa_halves(double a)
{
    const PaminsaHalves result = {{a / 2.0, -a / 2.0}};
    return result;
}

/* Two numbers of a kind, a PaminsaBothEnds. */
static inline PaminsaBothEnds paminsa_ends(double a)
{
    PaminsaBothEnds result;
    result.near = a;
    result.far = -a;
    return result;
}

/* What reads them. */
static inline double paminsa_composed(double a, double b)
{
    const PaminsaParts parts = paminsa_parts(a, b);
    const double total = parts.total;
    const double rest = parts.rest;
    const PaminsaParts parts_2 = paminsa_parts(rest, total);
    const double half = parts_2.rest;
    const PaminsaHalves halves = paminsa_halves(half);
    const double first = halves.values[0];
    const double second = halves.values[1];
    const PaminsaBothEnds both_ends = paminsa_ends(first);
    const double near = both_ends.near;
    const double far = both_ends.far;
    const PaminsaBothEnds both_ends_2 = paminsa_ends(far);
    return near * second - both_ends_2.near;
}
""",
    JavaScript: """\
/* Two numbers with names. */
function paminsaParts(a, b) {
    const total = a + b;
    const rest = a - b;
    return { total: total, rest: rest };
}

/* Two numbers without. */
function paminsaHalves(a) {
    return [a / 2.0, -a / 2.0];
}

/* Two numbers of a kind, a BothEnds. */
function paminsaEnds(a) {
    return { near: a, far: -a };
}

/* What reads them. */
function paminsaComposed(a, b) {
    const parts = paminsaParts(a, b);
    const total = parts.total;
    const rest = parts.rest;
    const parts_2 = paminsaParts(rest, total);
    const half = parts_2.rest;
    const halves = paminsaHalves(half);
    const first = halves[0];
    const second = halves[1];
    const both_ends = paminsaEnds(first);
    const near = both_ends.near;
    const far = both_ends.far;
    const both_ends_2 = paminsaEnds(far);
    return near * second - both_ends_2.near;
}
""",
}
"""The formula `composed` as somebody writes it by hand."""


@pytest.mark.parametrize("language", [C99, JavaScript])
def test_formulas_are_printed_as_they_are_written_by_hand(language: Any) -> None:
    printer = Printer(language())
    printer.add(composed)
    assert printer.text().strip() == WRITTEN[language].strip()
    assert printer.text().endswith("}\n")


def test_long_statements_are_filled_with_an_indent() -> None:
    words = [chr(97 + number) * (1 + number * 7 % 11) for number in range(26)]
    for indent, width, at in ((0, 30, " "), (4, 21, " "), (4, 24, ", ")):
        lines = filled(at.join(words), indent, at, width)
        assert " ".join(line.strip() for line in lines) == at.join(words)
        assert max(map(len, lines)) <= width
        leads = [len(line) - len(line.lstrip()) for line in lines]
        assert leads == [indent] + [indent + 4] * (len(lines) - 1)
        for line, after in itertools.pairwise(lines):  # none takes the next word
            assert len(f"{line} {after.strip().split(at)[0]}{at.rstrip()}") > width


def chosen(a: Any, b: Any, d: Any) -> Any:
    """A formula with every place where parentheses matter."""
    first = a - (b - d) - (a - b) / (d / a) * -(b + a)
    second = where((a < b) == ((b < d) & (d < a)), where(a < d, a, b), b) * (a + d)
    third = where(((b < d) | (d < a)) != (a < b), a - (b + d), -(a * b)) / (a / (b - d))
    fourth = where((a < b) | (b < d) & (d < a), b - (-a), -(a / b)) - (second - third)
    return first - fourth - where((a < b) & ((b < d) | (d == a)), a / (b * d), -(b - a))


def numbers_for_parentheses() -> dict[str, Any]:
    drawn = np.random.default_rng(1).normal(size=(3, 500))
    return {"x": np.zeros(500)} | dict(zip(["a", "b", "d"], drawn, strict=True))


def test_parentheses_keep_the_order_of_operations(tmp_path: Path) -> None:
    given = numbers_for_parentheses()
    program, width = c_program([chosen], given)
    got = np.frombuffer(run_c(tmp_path, program, "gcc", table(given))).reshape(-1, width)
    assert same_bits(got, on_numpy([chosen], given)).all()


@pytest.mark.skipif(shutil.which("node") is None, reason="no node here")
def test_parentheses_keep_the_order_of_operations_in_javascript(tmp_path: Path) -> None:
    given = numbers_for_parentheses()
    program, width = js_program([chosen], given)
    got = run_js(tmp_path, program, table(given)).reshape(-1, width)
    assert same_bits(got, on_numpy([chosen], given)).all()
