"""FMUs in FMPy: valid, and moved as Python computes it."""

from __future__ import annotations

import io
import json
import shutil
import subprocess
import sys
import zipfile
from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from paminsa_viz.codegen import add_platform
from paminsa_viz.codegen.add_platform import NotBuilt, compiler_words, with_platform
from paminsa_viz.codegen.fmu import (
    FmuKind,
    NoCompiler,
    build_fmu,
    fmu_folder,
    fmu_sources,
)
from paminsa_viz.engines.poses import start_pose
from paminsa_viz.errors import UnreachablePose
from paminsa_viz.files.archives import zipped
from paminsa_viz.model import (
    APPENDIX_4,
    Design,
    Geometry,
    forward_dynamics,
    inverse_dynamics,
    inverse_jacobian,
    inverse_kinematics,
    static_torques,
)
from paminsa_viz.model.reach import Limit
from tests.codegen.printed import SANITIZERS, STRICT, compilers, sanitizes
from tests.codegen.test_fmu_description import ACTUATORS, DRIVEN, KINDS, POSE, RATES, TORQUES
from tests.codegen.test_kit import loaded_robot
from tests.support import samples

fmpy = pytest.importorskip("fmpy", reason="FMPy comes with the extra 'test'")

from fmpy.fmi1 import FMICallException  # noqa: E402
from fmpy.fmi2 import FMU2Slave  # noqa: E402
from fmpy.validation import validate_fmu  # noqa: E402

pytestmark = [
    pytest.mark.skipif(shutil.which("cc") is None, reason="no C compiler here"),
    pytest.mark.filterwarnings("ignore::DeprecationWarning"),
]

SOURCES = fmu_sources(APPENDIX_4, "inverse")

built = cache(build_fmu)


def written(folder: Path, design: Design, kind: FmuKind) -> Path:
    path = folder / f"{kind}.fmu"
    path.write_bytes(built(design, kind))
    return path


@contextmanager
def running(path: Path, folder: Path, **start: float) -> Iterator[Any]:
    """Yield a slave that is initialized."""
    described = fmpy.read_model_description(path)
    place = fmpy.extract(str(path), unzipdir=str(folder / "unzipped"))
    name = described.coSimulation.modelIdentifier
    slave = FMU2Slave(
        guid=described.guid, unzipDirectory=place, modelIdentifier=name, instanceName="robot"
    )
    references = {v.name: v.valueReference for v in described.modelVariables}
    setattr(slave, "references", references)  # noqa: B010
    slave.instantiate()
    slave.setupExperiment(startTime=0.0)
    slave.enterInitializationMode()
    put(slave, **start)
    slave.exitInitializationMode()
    try:
        yield slave
    finally:
        slave.terminate()
        slave.freeInstance()


def put(slave: Any, **values: float) -> None:
    if values:
        slave.setReal([slave.references[name] for name in values], list(values.values()))


def get(slave: Any, names: tuple[str, ...]) -> np.ndarray:
    return np.array(slave.getReal([slave.references[name] for name in names]))


def by_dop853(design: Design, torque: Any, state: Any, time: float) -> np.ndarray:
    def rates(_: float, now: np.ndarray) -> np.ndarray:
        return np.concatenate([now[4:], forward_dynamics(design, now[:4], now[4:], torque)])

    solved = solve_ivp(rates, (0, time), state, method="DOP853", rtol=1e-13, atol=1e-15)
    return solved.y[:, -1]


@pytest.mark.slow
@pytest.mark.parametrize("kind", KINDS)
def test_fmpy_finds_no_problem(kind: FmuKind, tmp_path: Path) -> None:
    design = DRIVEN if kind == "plant" else loaded_robot()  # others move these
    assert validate_fmu(str(written(tmp_path, design, kind))) == []


@pytest.mark.slow
@pytest.mark.parametrize("design", [APPENDIX_4, DRIVEN], ids=["appendix-4", "driven"])
def test_plant_moves_as_python_integrates_it(design: Design, tmp_path: Path) -> None:
    """Torques change once, and a payload is put on, at a step's end."""
    steps, each = 40, 1e-3
    pose = start_pose(design) + np.array([0.02, -0.01, 0.1, 0.03])
    rate = np.array([0.05, 0.02, -0.1, 0.04])
    first = static_torques(design, pose) + np.array([0.4, -0.3, 0.2, 6.0])
    second = first + np.array([-0.8, 0.2, 0.1, 9.0])
    start = dict(zip([f"{name}_start" for name in (*POSE, *RATES)], [*pose, *rate], strict=True))
    heavier = design.vary({"payload.mass": 4.0, "payload.inertia": 0.03})
    state = by_dop853(design, first, np.concatenate([pose, rate]), steps * each)
    state = by_dop853(heavier, second, state, steps * each)
    with running(written(tmp_path, design, "plant"), tmp_path, **start) as slave:
        np.testing.assert_array_equal(get(slave, (*POSE, *RATES)), [*pose, *rate])
        put(slave, **dict(zip(TORQUES, first, strict=True)))
        for step in range(2 * steps):
            if step == steps:
                put(slave, **dict(zip(TORQUES, second, strict=True)))
                put(slave, payload_mass=4.0, payload_inertia=0.03)
            slave.doStep(currentCommunicationPoint=each * step, communicationStepSize=each)
        np.testing.assert_allclose(get(slave, (*POSE, *RATES)), state, rtol=0, atol=1e-11)
        found = inverse_kinematics(design.geometry, state[:4])
        np.testing.assert_allclose(get(slave, ACTUATORS), found.actuators, rtol=0, atol=1e-11)
        speed = inverse_jacobian(design.geometry, state[:4]) @ state[4:]
        rates = tuple(f"{name}_rate" for name in ACTUATORS)
        np.testing.assert_allclose(get(slave, rates), speed, rtol=0, atol=1e-10)
        assert slave.getInteger([0]) == [0]


@pytest.mark.slow
def test_a_saved_state_is_gone_on_with_to_the_last_bit(tmp_path: Path) -> None:
    with running(written(tmp_path, APPENDIX_4, "plant"), tmp_path) as slave:
        put(slave, tau_1=0.5, F_4=300.0)

        def play(start: float) -> np.ndarray:
            for step in range(20):
                slave.doStep(start + 1e-3 * step, 1e-3)
            return get(slave, (*POSE, *RATES))

        play(0.0)
        saved = slave.getFMUstate()
        stored = slave.serializeFMUstate(saved)
        after = play(0.02)
        put(slave, tau_1=-1.0, payload_mass=3.0)
        assert not np.array_equal(play(0.04), after)
        slave.setFMUstate(saved)
        np.testing.assert_array_equal(play(0.02), after)
        slave.freeFMUstate(saved)
        read = slave.deSerializeFMUstate(stored)
        slave.setFMUstate(read)
        np.testing.assert_array_equal(play(0.02), after)
        slave.freeFMUstate(read)
        slave.reset()
        with pytest.raises(FMICallException):
            put(slave, x=0.1)  # an output


@pytest.mark.slow
def test_only_the_status_that_there_is_is_told(tmp_path: Path) -> None:
    done, pending, reached, ended = range(4)  # fmi2StatusKind
    with running(written(tmp_path, APPENDIX_4, "plant"), tmp_path) as slave:
        slave.doStep(0.0, 0.25)
        assert slave.getRealStatus(reached) == 0.25
        assert slave.getBooleanStatus(ended) is False
        for ask, kind in (
            (slave.getStatus, done), (slave.getRealStatus, ended), (slave.getIntegerStatus, done),
            (slave.getBooleanStatus, reached), (slave.getStringStatus, pending),
        ):  # fmt: skip
            with pytest.raises(FMICallException) as caught:
                ask(kind)
            assert caught.value.status == 2  # fmi2Discard: the simulation may go on
        slave.doStep(0.25, 0.25)
        assert slave.getRealStatus(reached) == 0.5


RESUMED = """
#include <stdio.h>
#include <stdlib.h>
#include "paminsa_plant.c"

static fmi2Byte bytes[10000];

/* save: run for 20 ms, write the state; resume: read it into a new instance. Then run on. */
int main(int count, char **words)
{
    const fmi2CallbackFunctions callbacks = {NULL, calloc, free, NULL, NULL};
    const fmi2ValueReference torque = TAU_1, fixed = X_START, first = FIRST_OUTPUT;
    const int saves = count == 2 && strcmp(words[1], "save") == 0;
    const double drive = 0.5;
    double time;
    fmi2FMUstate state = NULL;
    size_t size;
    int failures = 0;
    fmi2Component c = fmi2Instantiate("robot", fmi2CoSimulation, GUID, "", &callbacks, 0, 0);

    if (saves) {
        failures += fmi2SetupExperiment(c, 0, 0.0, 1.5, 0, 0.0) != fmi2OK;
        failures += fmi2EnterInitializationMode(c) != fmi2OK;
        failures += fmi2ExitInitializationMode(c) != fmi2OK;
        failures += fmi2SetReal(c, &torque, 1, &drive) != fmi2OK;
        for (int i = 0; i < 20; i++)
            failures += fmi2DoStep(c, 1.5 + 1e-3 * i, 1e-3, 1) != fmi2OK;
        failures += fmi2GetFMUstate(c, &state) != fmi2OK;
        failures += fmi2SerializedFMUstateSize(c, state, &size) != fmi2OK || size > sizeof bytes;
        failures += fmi2SerializeFMUstate(c, state, bytes, size) != fmi2OK;
        failures += fwrite(bytes, 1, size, stdout) != size;
    } else {
        size = fread(bytes, 1, sizeof bytes, stdin);
        if (fmi2DeSerializeFMUstate(c, bytes, size, &state) != fmi2OK) {
            fmi2FreeInstance(c);
            return 9;
        }
        failures += fmi2SetFMUstate(c, state) != fmi2OK;
    }
    failures += fmi2FreeFMUstate(c, &state) != fmi2OK || state != NULL;
    failures += fmi2SetReal(c, &fixed, 1, &drive) != fmi2Error;
    for (int i = 20; i < 40; i++)
        failures += fmi2DoStep(c, 1.5 + 1e-3 * i, 1e-3, 1) != fmi2OK;
    for (fmi2ValueReference i = first; i < COUNT; i++) {
        double value;
        failures += fmi2GetReal(c, &i, 1, &value) != fmi2OK;
        fprintf(stderr, "%a ", value);
    }
    failures += fmi2GetRealStatus(c, fmi2LastSuccessfulTime, &time) != fmi2OK;
    fprintf(stderr, "%a", time);
    fmi2FreeInstance(c);
    return failures;
}
"""


@pytest.mark.slow
def test_a_saved_state_is_gone_on_with_in_another_process(tmp_path: Path) -> None:
    for name, text in fmu_sources(DRIVEN, "plant").items():
        (tmp_path / Path(name).name).write_text(text)
    (tmp_path / "resumed.c").write_text(RESUMED)
    checks = SANITIZERS if sanitizes("cc", tmp_path) else ()
    command = ["cc", *STRICT, *checks, "resumed.c", "-o", "resumed", "-lm"]
    built = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True)
    assert built.returncode == 0, built.stderr[:2000]

    def run(word: str, state: bytes = b"") -> tuple[int, bytes, bytes]:
        command = [tmp_path / "resumed", word]
        done = subprocess.run(command, input=state, capture_output=True)
        return done.returncode, done.stdout, done.stderr

    code, saved, ended = run("save")
    assert code == 0, ended
    values = [float.fromhex(word) for word in ended.decode().split()]
    assert values[-1] == pytest.approx(1.54)
    assert abs(values[2] - start_pose(DRIVEN)[2]) > 1e-5  # it has moved
    assert run("resume", saved) == (0, b"", ended)
    guid = saved.rindex(b"{")
    for other in (b"", saved[:-8], saved + b"0", saved[:guid] + b"}" + saved[guid + 1 :]):
        assert run("resume", other)[0] == 9


@pytest.mark.slow
def test_inverse_block_is_inverse_dynamics(tmp_path: Path) -> None:
    design = loaded_robot()
    moving = [POSE, RATES, tuple(f"{name}_acceleration" for name in POSE)]
    heavier = design.vary({"payload.mass": 6.0, "payload.inertia": 0.02})
    states = zip(*samples.random_states(np.random.default_rng(2), design, 20), strict=True)
    with running(written(tmp_path, design, "inverse"), tmp_path) as slave:
        for number, state in enumerate(states):
            carries = heavier if number % 2 else design
            load = carries.payload
            put(slave, payload_mass=load.mass, payload_inertia=load.inertia)
            for names, values in zip(moving, state, strict=True):
                put(slave, **dict(zip(names, values, strict=True)))
            wanted = inverse_dynamics(carries, *state).torque
            np.testing.assert_allclose(get(slave, TORQUES), wanted, rtol=1e-11, atol=1e-11)
            found = inverse_kinematics(design.geometry, state[0]).actuators
            np.testing.assert_allclose(get(slave, ACTUATORS), found, rtol=0, atol=1e-12)
        put(slave, x=3.0)
        assert np.isnan(get(slave, TORQUES)).all()
        assert slave.getInteger([0]) == [2]


POSE_BEFORE = np.array([0.20, 0.02, 0.1, -0.55])
RATES_BEFORE = np.array([1.0, 0.1, 0.0, 0.0])


@cache
def past_the_singularity() -> np.ndarray:
    """Pose and rates 0.1 s later, with the torques that hold the robot before."""
    torque = static_torques(APPENDIX_4, POSE_BEFORE)

    def growth(t: float, state: np.ndarray) -> np.ndarray:
        found = forward_dynamics(APPENDIX_4, state[:4], state[4:], torque)
        return np.concatenate([state[4:], found])

    return solve_ivp(
        growth, (0.0, 0.1), [*POSE_BEFORE, *RATES_BEFORE], method="DOP853", rtol=1e-10, atol=1e-12
    ).y[:, -1]


@pytest.mark.slow
@pytest.mark.parametrize("step_max", [1e-4, 1e-3, 1e-2])
def test_a_type_2_singularity_is_passed_and_a_leg_axis_is_not(
    tmp_path: Path, step_max: float
) -> None:
    """On the singular circle at theta = 0 a leg axis is met where P moves straight toward it."""
    path = written(tmp_path, APPENDIX_4, "plant")
    solved = past_the_singularity()

    def starts(pose: Any, rates: Any) -> dict[str, float]:
        named = zip((*POSE, *RATES), (*pose, *rates), strict=True)
        return {f"{name}_start": float(value) for name, value in named}

    first, last = platform_determinants([POSE_BEFORE, solved[:4]])
    assert first * last < 0
    forces = dict(zip(TORQUES, static_torques(APPENDIX_4, POSE_BEFORE), strict=True))
    before = starts(POSE_BEFORE, RATES_BEFORE)
    with running(path, tmp_path / "crosses", **before, **forces, step_max=step_max) as slave:
        slave.doStep(0.0, 0.1)
        assert get(slave, (*POSE, *RATES)) == pytest.approx(solved, abs=1e2 * step_max**4 + 1e-9)
    axis = starts([0.0, 0.2, 0.0, -0.55], [0.0, 2.0, 0.0, 0.0])
    with running(path, tmp_path / "axis", **axis, step_max=step_max) as slave:
        with pytest.raises(FMICallException):
            slave.doStep(0.0, 0.1)
        assert slave.getInteger([0]) == [Limit.AXIS]


def platform_determinants(poses: Any) -> np.ndarray:
    """Return the determinants of the inverse Jacobian, which change their sign at type 2."""
    return np.linalg.det(inverse_jacobian(APPENDIX_4.geometry, poses))


@pytest.mark.slow
def test_what_cannot_move_says_so(tmp_path: Path) -> None:
    path = written(tmp_path, APPENDIX_4, "plant")
    with (
        pytest.raises(FMICallException),
        running(path, tmp_path / "far", x_start=3.0),
    ):
        pass
    with running(path, tmp_path / "runs") as slave:
        before = get(slave, POSE)
        for wrong in ({"tau_2": np.nan}, {"payload_mass": -1.0}):
            put(slave, **wrong)
            with pytest.raises(FMICallException):
                slave.doStep(0.0, 1e-3)
            put(slave, tau_2=0.0, payload_mass=0.0)
        np.testing.assert_array_equal(get(slave, POSE), before)


@pytest.mark.slow
@pytest.mark.parametrize("compiler", compilers())
@pytest.mark.parametrize("kind", KINDS)
def test_sources_compile_without_a_warning(kind: FmuKind, compiler: str, tmp_path: Path) -> None:
    for name, text in fmu_sources(APPENDIX_4, kind).items():
        (tmp_path / Path(name).name).write_text(text)
    command = [compiler, *STRICT, "-c", f"paminsa_{kind}.c"]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr[:2000]


COMPILER = """
import json, pathlib, sys
words = sys.argv[1:]
if "--fail" in words:
    sys.exit(3)
if "--old" in words:
    sys.stderr.buffer.write(b"d\\xe9faut")
    sys.exit(1)
if "--say" in words:
    sys.exit("model.c:\\n  " + 600 * "x")
pathlib.Path(words[words.index("-o") + 1]).write_text(json.dumps(words))
"""


@pytest.mark.slow
def test_the_script_adds_another_platform(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """By what says that it is a compiler: real ones make what others run."""
    script = tmp_path / "compiler.py"
    script.write_text(COMPILER)
    monkeypatch.setenv("CC", f"{sys.executable} {script}")
    for name, content in fmu_folder(APPENDIX_4, ["inverse"]).items():
        path = tmp_path / Path(name).name
        path.write_bytes(content.encode() if isinstance(content, str) else content)

    def run(*words: str) -> subprocess.CompletedProcess[str]:
        command = [sys.executable, "add_platform.py", "paminsa_inverse.fmu", *words]
        return subprocess.run(command, cwd=tmp_path, capture_output=True, text=True)

    before = (tmp_path / "paminsa_inverse.fmu").read_bytes()
    for words in (("atari", "cc"), ("linux32", "no-such-compiler"), ("linux32", "cc -Dint=")):
        done = run(*words)
        assert (done.returncode, len(done.stderr.splitlines())) == (1, 1)
        assert (tmp_path / "paminsa_inverse.fmu").read_bytes() == before
    done = run("linux32")
    assert (done.returncode, "add_platform.py paminsa_plant.fmu" in done.stdout) == (2, True)
    done = run("linux32", f"{sys.executable} {script}")
    said = "paminsa_inverse.fmu: has a binary for linux32\n"
    assert (done.returncode, done.stdout) == (0, said)
    with zipfile.ZipFile(tmp_path / "paminsa_inverse.fmu") as archive:
        inside = archive.namelist()
        assert archive.testzip() is None
    assert "binaries/linux32/paminsa_inverse.so" in inside
    with zipfile.ZipFile(io.BytesIO(before)) as archive:
        assert set(archive.namelist()) < set(inside)


def test_the_script_names_the_file_and_what_is_wrong_with_it_or_the_words(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "text.fmu").write_text("no zip file")
    for name, inside in (("empty.fmu", "a.txt"), ("small.fmu", "sources/small.c")):
        with zipfile.ZipFile(tmp_path / name, "w") as archive:
            archive.writestr(inside, "")
    for name, platform, compiler, said in (
        ("no.fmu", "linux64", "cc", "No such file"),
        ("text.fmu", "linux64", "cc", "it is no FMU, which is a zip file"),
        ("empty.fmu", "linux64", "cc", "no C sources"),
        ("small.fmu", "linux", "cc", "there is no platform 'linux'; there are linux64, linux32"),
        ("small.fmu", "linux64", " ", "a compiler has to be named"),
        ("small.fmu", "linux64", '"cc', "No closing quotation"),
        ("small.fmu", "linux64", f"{sys.executable} -c pass", "made no small.so"),
    ):
        path = str(tmp_path / name)
        assert add_platform.main([path, platform, compiler]) == 1
        err = capsys.readouterr().err
        assert (err.startswith(f"{path}: "), said in err, err.count("\n")) == (True, True, 1), err


@pytest.mark.parametrize("platform", ["linux64", "win64", "darwin64"])
def test_a_platform_is_added_with_its_own_name_and_options(platform: str, tmp_path: Path) -> None:
    script = tmp_path / "compiler.py"
    script.write_text(COMPILER)
    packed = zipped({name: text.encode() for name, text in SOURCES.items()})
    made = with_platform(packed, platform, f"{sys.executable} {script} -m64")
    ending = {"linux64": "so", "win64": "dll", "darwin64": "dylib"}[platform]
    with zipfile.ZipFile(io.BytesIO(made)) as archive:
        binary = f"binaries/{platform}/paminsa_inverse.{ending}"
        assert set(archive.namelist()) == {*SOURCES, binary}
        assert {info.external_attr >> 16 for info in archive.infolist()} == {0o644}
        for name, text in SOURCES.items():
            assert archive.read(name).decode() == text
        words = json.loads(archive.read(binary))
    assert words[0] == "-m64"
    last = ["paminsa_inverse.c", "-o", f"paminsa_inverse.{ending}"]
    # Windows has no library m: clang's linker there looks for a file m.lib and fails.
    assert words[words.index(last[0]) :] == (last if platform == "win64" else [*last, "-lm"])
    assert {"-std=c99", "-shared", "-ffp-contract=off"} <= set(words)
    assert ("-fPIC" in words) == ("-fvisibility=hidden" in words) == (platform != "win64")
    with pytest.raises(NotBuilt, match="failed: exit code 3"):
        with_platform(packed, platform, f"{sys.executable} {script} --fail")
    compiler = f"{sys.executable} {script} --say"
    with pytest.raises(NotBuilt) as caught:
        with_platform(packed, platform, compiler)
    start = f"{compiler} failed: "
    assert str(caught.value) == (start + "model.c: " + 600 * "x")[: len(start) + 500]
    with pytest.raises(NotBuilt, match="failed: d\ufffdfaut"):  # in the code page of a terminal
        with_platform(packed, platform, f"{sys.executable} {script} --old")


def test_a_compiler_is_a_path_with_spaces_or_a_command_and_its_options(tmp_path: Path) -> None:
    """Backslashes separate folders on Windows, elsewhere they escape what follows."""
    path = tmp_path / "my compiler"
    path.write_text("#!/bin/sh\n")
    path.chmod(0o755)
    clang = r"C:\Program Files\LLVM\bin\clang.exe"
    for text, separator, words in (
        (str(path), "/", [str(path)]),
        (r"C:\msys64\bin\gcc.exe -m32", "\\", [r"C:\msys64\bin\gcc.exe", "-m32"]),
        (f'"{clang}" -g', "\\", [clang, "-g"]),
        (r"my\ gcc '-DA=#1'", "/", ["my gcc", "-DA=#1"]),
    ):
        assert compiler_words(text, separator) == words, text


def test_without_a_compiler_or_a_start_there_is_none(monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(UnreachablePose):
        build_fmu(Design(Geometry(base_radius=0.2, platform_radius=0.2)), "plant")
    monkeypatch.setenv("CC", "no-such-compiler")
    with pytest.raises(NoCompiler, match="no-such-compiler: No such file"):
        build_fmu(APPENDIX_4, "plant")
    monkeypatch.delenv("CC")
    monkeypatch.setenv("PATH", "")
    with pytest.raises(NoCompiler, match="install gcc or clang"):
        build_fmu(APPENDIX_4, "plant")
