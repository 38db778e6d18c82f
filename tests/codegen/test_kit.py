"""The controller kit: what is written compiles without a warning and agrees with Python."""

from __future__ import annotations

import re
import subprocess
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from benchmarks.code_speed import GOALS, text_size
from paminsa_viz.codegen import controller_kit, kit
from paminsa_viz.codegen.kit import (
    SINGLE_BOUNDS,
    TOLERANCE,
    TOLERANCES,
    header,
    single_precision,
)
from paminsa_viz.model import (
    APPENDIX_4,
    Design,
    leg,
)
from paminsa_viz.model.leg import mechanism
from paminsa_viz.model.lumped import term_factors
from paminsa_viz.model.parameters import Counterweight
from paminsa_viz.model.reach import Limit
from paminsa_viz.model.robot import inverse_dynamics_kernel
from tests.codegen.printed import SANITIZERS, STRICT, compilers, sanitizes
from tests.codegen.robots import DESIGNS, SIZES, loaded_robot
from tests.support.documentation import missing


def write(folder: Path, design: Design, *, single: bool = False) -> None:
    for name, text in controller_kit(design, single=single).items():
        (folder / name).write_text(text)


def build(folder: Path, design: Design, compiler: str, *flags: str, single: bool = False) -> None:
    write(folder, design, single=single)
    command = [compiler, *STRICT, *(flags or ("-O1",)), "test.c", "-o", "test", "-lm"]
    built = subprocess.run(command, cwd=folder, capture_output=True, text=True)
    assert built.returncode == 0, built.stderr[:2000]


def run_test(folder: Path, program: Path | str = "./test") -> subprocess.CompletedProcess[str]:
    return subprocess.run([program], cwd=folder, capture_output=True, text=True)


OPTIMIZED = "loaded"
"""The design whose code both compilers look at closely, which takes most of the time."""


@pytest.fixture(scope="module")
def appendix_4(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The kit of Appendix 4 with its test program, which reads the table of where it runs."""
    folder = tmp_path_factory.mktemp("kit")
    build(folder, APPENDIX_4, "gcc", "-O0")
    return folder


@pytest.mark.slow
@pytest.mark.parametrize("compiler", compilers())
def test_optimized_c_agrees_with_python(compiler: str, tmp_path: Path) -> None:
    build(tmp_path, DESIGNS[OPTIMIZED], compiler, "-O1", "-Wconversion")
    check_agreement(tmp_path)


@pytest.mark.slow
@pytest.mark.parametrize("name", [name for name in DESIGNS if name != OPTIMIZED])
def test_c_agrees_with_python(name: str, tmp_path: Path) -> None:
    build(tmp_path, DESIGNS[name], "gcc", "-O0", "-Wconversion")
    check_agreement(tmp_path)


STRICT_CPP = (
    "-std=c++11",
    *(flag for flag in STRICT if "std" not in flag),
    "-Wconversion",
    "-Wshadow",
)


@pytest.mark.slow
@pytest.mark.parametrize("single", [False, True])
@pytest.mark.parametrize("compiler", compilers(["g++", "clang++"]))
def test_cpp_agrees_with_python(compiler: str, single: bool, tmp_path: Path) -> None:
    write(tmp_path, DESIGNS["appendix-4"], single=single)
    command = [compiler, "-x", "c++", *STRICT_CPP, "-O0", "test.c", "-o", "test"]
    built = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True)
    assert (built.returncode, built.stderr[:2000]) == (0, "")
    if single:
        assert run_test(tmp_path).returncode == 0
    else:
        check_agreement(tmp_path)


def check_agreement(folder: Path) -> None:
    done = run_test(folder)
    assert (done.returncode, done.stderr) == (0, ""), done.stdout
    assert "440 rows, tolerance 1e-09: passed" in done.stdout
    # None where NumPy made the vectors; compiled kernels, which other tests load, round otherwise.
    formulas = re.search(r"formulas, given cos and sin theta +worst error +(\S+)", done.stdout)
    assert formulas is not None
    assert float(formulas[1]) < 1e-12


DRAWS = 6
"""Tables of vectors by which single precision is judged."""


@pytest.mark.slow
@pytest.mark.parametrize("name", ["appendix-4", "upper-knee", "loaded", *SIZES])
def test_single_precision_keeps_the_bounds_that_the_readme_states(
    name: str, tmp_path: Path
) -> None:
    warned = ("-Wconversion", "-Wdouble-promotion")
    design = (DESIGNS | SIZES)[name]
    build(tmp_path, design, "gcc", "-O0", *warned, single=True)
    readme = " ".join((tmp_path / "README.md").read_text().split())
    for draw in range(DRAWS):  # the worst of one table is a matter of chance
        (tmp_path / "vectors.csv").write_text(kit.test_vectors(design, draw))
        done = run_test(tmp_path)
        assert done.returncode == 0, done.stdout
        worst = {
            line[:34].strip(): float(line.split()[-1])
            for line in done.stdout.splitlines()
            if "worst error" in line
        }
        for what, bound in SINGLE_BOUNDS.items():
            assert worst[what] <= bound, (draw, what)
            assert f"{what} {bound:g}" in readme
    # a torque that is wrong by a hundredth of its actuator's largest, however small that is
    head, *rows = (tmp_path / "vectors.csv").read_text().splitlines()
    names, cells = head.split(","), [row.split(",") for row in rows]
    static, moved = names.index("static_2"), names.index("torque_2")
    largest = np.nanmax(np.abs([[float(row[static]), float(row[moved])] for row in cells]))
    cells[0][static] = repr(float(cells[0][static]) + 0.01 * float(largest))
    changed = "\n".join([head, *map(",".join, cells)]) + "\n"
    (tmp_path / "vectors.csv").write_text(changed)
    assert run_test(tmp_path).returncode == 1


@pytest.mark.slow
def test_a_wrong_number_fails_the_test_program(appendix_4: Path, tmp_path: Path) -> None:
    text = (appendix_4 / "vectors.csv").read_text().splitlines()
    cells = text[5].split(",")
    column = text[0].split(",").index("torque_2")
    cells[column] = repr(float(cells[column]) * (1 + 1e-6))
    text[5] = ",".join(cells)
    (tmp_path / "vectors.csv").write_text("\n".join(text) + "\n")
    done = run_test(tmp_path, appendix_4 / "test")
    assert done.returncode == 1
    assert "FAILED" in done.stdout


@pytest.mark.slow
@pytest.mark.parametrize("content", [None, "", "pose_0,pose_1\n", "head\n1,2,three\n"])
def test_an_unusable_table_is_no_success(
    content: str | None, appendix_4: Path, tmp_path: Path
) -> None:
    if content is not None:
        (tmp_path / "vectors.csv").write_text(content)
    done = run_test(tmp_path, appendix_4 / "test")
    assert done.returncode == 2
    assert len(done.stderr.splitlines()) == 1


MISUSE = """
#include <stdio.h>
#include "paminsa.h"
#include "design.h"

static int all_nan(const double *values, int count)
{
    for (int i = 0; i < count; i++)
        if (!isnan(values[i]))
            return 0;
    return 1;
}

int main(void)
{
    const double odd[] = {0.0, NAN, INFINITY, -INFINITY, 1e308, -1e308, 5.0, 0.25, 5e-324};
    const int count = (int)(sizeof odd / sizeof odd[0]);
    double four[4], matrix[4][4], poses[2][4], margins[3][4], more[4];
    int seen[8] = {0};
    long calls = 0, wrong = 0;

    for (long code = 0; code < 6561; code++) {
        double pose[4];
        long rest = code;
        for (int i = 0; i < 4; i++, rest /= count)
            pose[i] = odd[rest % count];
        const double *v = pose;
        PaminsaReach reach = paminsa_inverse_kinematics(&PAMINSA_DESIGN, pose, four);
        seen[reach.status] = 1;
        wrong += reach.status != PAMINSA_STATUS_OK && !all_nan(four, 4);
        reach = paminsa_inverse_dynamics(&PAMINSA_DESIGN, pose, v, v, four);
        wrong += reach.status != PAMINSA_STATUS_OK && !all_nan(four, 4);
        reach = paminsa_forward_dynamics(&PAMINSA_DESIGN, pose, v, v, four);
        wrong += reach.status != PAMINSA_STATUS_OK && !all_nan(four, 4);
        reach = paminsa_static_torques(&PAMINSA_DESIGN, pose, four);
        wrong += reach.status != PAMINSA_STATUS_OK && !all_nan(four, 4);
        reach = paminsa_jacobian(&PAMINSA_DESIGN, pose, matrix);
        wrong += reach.status != PAMINSA_STATUS_OK && !all_nan(matrix[2], 4);
        reach = paminsa_mass_matrix_of(&PAMINSA_DESIGN, pose, matrix);
        wrong += reach.status != PAMINSA_STATUS_OK && !all_nan(matrix[1], 4);
        reach = paminsa_actuator_motion(&PAMINSA_DESIGN, pose, v, v, four, more);
        wrong += reach.status != PAMINSA_STATUS_OK && !(all_nan(four, 4) && all_nan(more, 4));
        wrong += paminsa_nearest_pose(&PAMINSA_DESIGN, pose, v, four) != PAMINSA_STATUS_OK &&
            !all_nan(four, 4);
        const int found = paminsa_forward_kinematics(&PAMINSA_DESIGN, pose, poses);
        wrong += found < 0 || found > 2 || (found < 2 && !all_nan(poses[1], 4));
        paminsa_margins(&PAMINSA_DESIGN, pose, margins);
        (void)paminsa_singularity(&PAMINSA_DESIGN, pose);
        calls++;
    }
    const double singular[4] = {0.0, 0.0, acos(0.1 / 0.35), -0.55};
    const double rest[4] = {0.0, 0.0, 0.0, 0.0};
    const PaminsaReach held =
        paminsa_inverse_dynamics(&PAMINSA_DESIGN, singular, rest, rest, four);
    wrong += held.status != PAMINSA_STATUS_SINGULAR || !all_nan(four, 4);
    PaminsaDesign carrying = PAMINSA_DESIGN;
    paminsa_set_payload(&carrying, 2.0, 0.0);
    const double home[4] = {0.0, 0.0, 0.0, -0.55};
    double empty[4];
    paminsa_static_torques(&PAMINSA_DESIGN, home, empty);
    paminsa_static_torques(&carrying, home, four);
    wrong += !(fabs(four[3] - empty[3] - 3.0 * 2.0 * 9.81) < 1e-9);
    printf("%ld calls, %ld wrong, seen", calls, wrong);
    for (int i = 0; i < 8; i++)
        printf(" %d", seen[i]);
    printf("\\n");
    return wrong != 0;
}
"""


@pytest.mark.slow
@pytest.mark.parametrize("compiler", compilers())
def test_no_input_makes_undefined_behavior_and_no_failure_leaves_a_number(
    compiler: str, tmp_path: Path
) -> None:
    if not sanitizes(compiler, tmp_path):
        pytest.skip(f"{compiler} has no sanitizers here")
    write(tmp_path, APPENDIX_4)
    (tmp_path / "misuse.c").write_text(MISUSE)
    command = [compiler, *STRICT, *SANITIZERS, "misuse.c", "-o", "misuse", "-lm"]
    built = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True)
    assert built.returncode == 0, built.stderr[:2000]
    done = subprocess.run(["./misuse"], cwd=tmp_path, capture_output=True, text=True)
    assert (done.returncode, done.stderr) == (0, ""), done.stdout + done.stderr[:1000]
    assert done.stdout.startswith("6561 calls, 0 wrong, seen 1 1 1")


MASSES = """
#include <stdio.h>
#include "paminsa.h"
#include "design.h"

int main(void)
{
    double masses[PAMINSA_MASS_COUNT];
    PaminsaDesign design = PAMINSA_DESIGN;

    for (int i = 0; i < PAMINSA_MASS_COUNT; i++)
        masses[i] = PAMINSA_MASSES[i];
    paminsa_set_masses(&design, masses);
    fwrite(&design.energy, sizeof design.energy, 1, stdout);
    masses[PAMINSA_JOINTS_J7] = 3.1;
    masses[PAMINSA_LINKS_B3] *= 2.0;
    masses[PAMINSA_INERTIAS_B8_TRANSVERSE] = 0.07;
    masses[PAMINSA_PLATFORM_MASS] = 4.0;
    masses[PAMINSA_COUNTERWEIGHT_1] = 0.9;
    paminsa_set_masses(&design, masses);
    fwrite(&design.energy, sizeof design.energy, 1, stdout);
    paminsa_set_payload(&design, 0.0, 0.0);
    fwrite(&design.energy.mass, sizeof design.energy.mass, 1, stdout);
    return 0;
}
"""


@pytest.mark.slow
def test_masses_change_while_a_program_runs(tmp_path: Path) -> None:
    design = replace(loaded_robot(), counterweights=(Counterweight("b8", 8, 0.4, 0.1),))
    changed = design.vary(
        {
            "joints.j7": 3.1, "links.b3": 2 * design.links.b3, "counterweights.0.mass": 0.9,
            "inertias.b8_transverse": 0.07, "platform.mass": 4.0,
        }
    )  # fmt: skip
    write(tmp_path, design)
    (tmp_path / "masses.c").write_text(MASSES)
    command = ["gcc", *STRICT, "masses.c", "-o", "masses", "-lm"]
    built = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True)
    assert built.returncode == 0, built.stderr[:2000]
    done = subprocess.run(["./masses"], cwd=tmp_path, capture_output=True)
    found = np.frombuffer(done.stdout)
    for got, robot in ((found[:21], design), (found[21:42], changed)):
        np.testing.assert_allclose(got, term_factors(robot), rtol=1e-13, atol=1e-15)
    assert found[42] == 4.0


def test_every_function_says_units_and_where_it_comes_from() -> None:
    kit = controller_kit(APPENDIX_4)
    text = kit["paminsa.h"] + kit["design.h"]
    pattern = r"(?:/\*((?:(?!\*/).)*)\*/\n)?static inline [\w ]+?\*?(\w+)\("
    functions = re.findall(pattern, text, re.DOTALL)
    assert len(functions) > 60
    assert not re.search(r"(?<!\*/)\n(typedef|static inline)", text)  # structs say theirs as well
    assert max(map(len, text.splitlines())) <= 100
    assert "`" not in text
    for comment, name in functions:
        comment = " ".join(comment.replace("*", " ").split())
        assert re.search(r"\[.+\]|no unit|[Uu]nits as of", comment), name
        assert re.search(r"Eqs?\. \d|Appendi|not in the paper|Not in the paper", comment), name


COLUMNS = """
#include <stdio.h>
#include "paminsa.h"
#include "design.h"

int main(void)
{
    static double in[13 * 3001], out[4 * 3001];
    const size_t count = fread(in, 13 * sizeof in[0], 3001, stdin);

    paminsa_inverse_dynamics_columns(&PAMINSA_DESIGN, (long)count, in, out);
    fwrite(out, 4 * sizeof out[0], count, stdout);
    return 0;
}
"""


@pytest.mark.slow
@pytest.mark.parametrize("compiler", compilers())
def test_many_states_at_once_have_the_bits_of_numpy(compiler: str, tmp_path: Path) -> None:
    design = DESIGNS["loaded"]
    write(tmp_path, design)
    (tmp_path / "columns.c").write_text(COLUMNS)
    flags = ["-O3", "-fno-math-errno", "-fno-trapping-math"]
    if compiler == "clang":
        flags += ["-mllvm", "-inline-threshold=10000"]
    command = [compiler, *STRICT, *flags, "columns.c", "-o", "columns", "-lm"]
    built = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True)
    assert built.returncode == 0, built.stderr[:2000]
    rng = np.random.default_rng(1)
    x, y, theta, z = rng.uniform((-0.3, -0.3, -1, -1), (0.3, 0.3, 1, -0.1), (3001, 4)).T
    states = [x, y, np.cos(theta), np.sin(theta), z, *rng.normal(size=(8, 3001))]
    rows = np.concatenate(states).tobytes()
    done = subprocess.run(["./columns"], cwd=tmp_path, input=rows, capture_output=True)
    got = np.frombuffer(done.stdout).reshape(4, 3001)
    m, e = mechanism(design.geometry), term_factors(design)
    with np.errstate(invalid="ignore"):
        wanted = inverse_dynamics_kernel(m, e, design.gravity, *states)[:4]
    np.testing.assert_array_equal(got, wanted)
    assert 0.3 < np.isfinite(got).all(axis=0).mean() < 0.9


@pytest.mark.slow
def test_inverse_dynamics_is_small(tmp_path: Path) -> None:
    """Its text is at most 12 kB at -Os, with all that it calls."""
    write(tmp_path, APPENDIX_4)
    small = text_size(tmp_path, "-Os", "-ffp-contract=off")
    assert 4_000 < small <= GOALS["bytes"]


def test_status_codes_are_those_of_the_model() -> None:
    text = controller_kit(APPENDIX_4)["paminsa.h"]
    codes = dict(re.findall(r"PAMINSA_STATUS_([A-Z_]+) = (\d)", text))
    assert {name: int(code) for name, code in codes.items() if name in Limit.__members__} == {
        limit.name: int(limit) for limit in Limit
    }


def test_the_header_needs_no_memory_no_globals_and_only_math_h() -> None:
    text = controller_kit(APPENDIX_4)["paminsa.h"]
    assert re.findall(r"#include.*", text) == ["#include <math.h>"]
    assert not re.search(r"\b(malloc|calloc|free|printf)\(", text)
    statics = [line for line in text.splitlines() if re.match(r"\s*static (?!inline)", line)]
    assert statics
    assert all("static const" in line for line in statics)


def test_msvc_reads_no_word_that_its_c_lacks(tmp_path: Path) -> None:
    """It knows `restrict` only from /std:c11 on, in C as in C++."""
    write(tmp_path, APPENDIX_4)
    command = ["gcc", "-std=c99", "-fsyntax-only", "-D_MSC_VER=1944", "-Drestrict=?", "test.c"]
    checked = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True)
    assert checked.returncode == 0, checked.stderr[:2000]


def test_names_from_outside_cannot_leave_their_comment() -> None:
    for name in ('*/ int x; /* "\n\\u00e9', "a/*/*b", "*//**/"):
        first = controller_kit(replace(APPENDIX_4, name=name))["design.h"].splitlines()[0]
        assert first.count("*/") == 1
        assert first.endswith("*/")
        assert first.count("/*") == 1  # compilers warn of a comment that begins within another


def test_tolerances_grow_as_the_last_place_of_a_number_does() -> None:
    coarser = np.finfo(np.float32).eps / np.finfo(np.float64).eps
    for name, value in TOLERANCES.items():
        assert value == getattr(leg, name) * coarser
        assert f"#define PAMINSA_{name} {value!r}" in single_precision(header())
    assert {TOLERANCE[True], max(SINGLE_BOUNDS.values())} == {5e-3}
    assert TOLERANCE[False] == 1e-9  # the documentation's
    low, high = (bound(SINGLE_BOUNDS.values()) for bound in (min, max))
    sentence = "from 1e-6 for inverse kinematics to 5e-3 for forward dynamics"
    assert missing("machine", [sentence]) == []
    assert (low, high) == (SINGLE_BOUNDS["inverse kinematics"], SINGLE_BOUNDS["forward dynamics"])
    assert (low, high) == (1e-6, 5e-3)
    for value in SINGLE_BOUNDS.values():  # in round numbers: 1, 2 or 5 times a power of ten
        assert f"{value:e}"[:8] in ("1.000000", "2.000000", "5.000000")


def test_only_code_becomes_single_precision() -> None:
    text = '/* 1e-8 double */ static double a = 1.5e-3 * sqrt(2.0) + x2.y; "0.5"'
    expected = '/* 1e-8 double */ static float a = 1.5e-3f * sqrtf(2.0f) + x2.y; "0.5"'
    assert single_precision(text) == expected
