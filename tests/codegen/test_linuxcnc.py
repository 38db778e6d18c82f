"""The kinematics module for LinuxCNC: there and back, with its headers or stand-ins for them."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest

from paminsa_viz.codegen import controller_kit
from paminsa_viz.model import APPENDIX_4, Design, KneeBranch, inverse_kinematics
from tests.codegen.printed import STRICT
from tests.support import samples

DESIGNS = {"appendix-4": APPENDIX_4, "upper-knee": APPENDIX_4.with_knee(KneeBranch.UPPER)}

HEADERS = {
    "rtapi_math.h": "#include <math.h>\n",
    "kinematics.h": """
#define EXPORT_SYMBOL(name) struct exported_##name
typedef struct { struct { double x, y, z; } tran; double a, b, c, u, v, w; } EmcPose;
typedef enum { KINEMATICS_IDENTITY = 1, KINEMATICS_BOTH = 4 } KINEMATICS_TYPE;
typedef unsigned long KINEMATICS_FORWARD_FLAGS, KINEMATICS_INVERSE_FLAGS;
""",
}
"""What the module takes of LinuxCNC: the layout of its types."""

DRIVER = """
#include <stdio.h>
typedef int Forward(const double *, EmcPose *, const unsigned long *, unsigned long *);
typedef int Inverse(const EmcPose *, double *, const unsigned long *, unsigned long *);

/* Reads X Y Z C, and where to start from; writes results, joints, and the pose found again. */
static int run(Forward *forward, Inverse *inverse, int kind)
{
    double row[8];

    if (kind != KINEMATICS_BOTH)
        return 1;
    while (fread(row, sizeof row, 1, stdin) == 1) {
        EmcPose pose = {{row[0], row[1], row[2]}, 0, 0, row[3], 0, 0, 0};
        EmcPose near = {{row[4], row[5], row[6]}, 1, 1, row[7], 1, 1, 1};
        double out[12] = {0};
        unsigned long flags = 0;
        out[0] = inverse(&pose, out + 2, &flags, &flags);
        out[1] = forward(out + 2, &near, &flags, &flags);
        out[6] = near.tran.x, out[7] = near.tran.y, out[8] = near.tran.z, out[9] = near.c;
        out[10] = near.a + near.b + near.u + near.v + near.w;
        fwrite(out, sizeof out, 1, stdout);
    }
    return 0;
}
"""

INCLUDED = (
    "int main(void) { return run(kinematicsForward, kinematicsInverse, kinematicsType()); }\n"
)

LOADED = """
#define _GNU_SOURCE
#include <dlfcn.h>
#include "kinematics.h"
@DRIVER@
int main(void)
{
    void *module = dlopen("./paminsakins.so", RTLD_LAZY);
    int (*kind)(void);
    Forward *forward;
    Inverse *inverse;

    if (module == NULL)
        return 2;
    *(void **)&kind = dlsym(module, "kinematicsType");
    *(void **)&forward = dlsym(module, "kinematicsForward");
    *(void **)&inverse = dlsym(module, "kinematicsInverse");
    return run(forward, inverse, kind());
}
"""


def compiled(folder: Path, text: str, *flags: str) -> None:
    (folder / "driver.c").write_text(text)
    command = ["gcc", *STRICT, "-I.", *flags, "driver.c", "-o", "driver", "-lm", "-ldl"]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr[:2000]


def write(folder: Path, design: Design) -> str:
    """Write the kit and the stand-ins, and return the C of the module."""
    for name, text in {**controller_kit(design), **HEADERS}.items():
        (folder / name).write_text(text)
    return (folder / "paminsakins.comp").read_text().partition(";;\n")[2]


def check(folder: Path, design: Design) -> None:
    """Go there and back over poses, from nearby, and where there is no way."""
    rng = np.random.default_rng(6)
    pose = samples.random_poses(rng, design, 200)
    world = pose[:, [0, 1, 3, 2]] * [1e3, 1e3, 1e3, np.degrees(1)]
    near = world + rng.uniform(-1, 1, world.shape) * [3, 3, 3, 1]
    far = world + np.array([5000, 0, 0, 0])
    rows = np.concatenate([np.hstack([world, near]), np.hstack([far, near])])
    done = subprocess.run(["./driver"], cwd=folder, input=rows.tobytes(), capture_output=True)
    assert done.returncode == 0
    found = np.frombuffer(done.stdout).reshape(-1, 12)
    there, away = found[:200], found[200:]
    assert (there[:, :2] == 0).all()
    joints = inverse_kinematics(design.geometry, pose).actuators
    wanted = joints * [*np.degrees([1, 1, 1]), 1e3]
    np.testing.assert_allclose(there[:, 2:6], wanted, rtol=0, atol=1e-9)
    np.testing.assert_allclose(there[:, 6:10], world, rtol=0, atol=1e-7)
    assert (there[:, 10] == 0).all()
    assert (away[:, 0] == -1).all()
    assert (away[:, 2:6] == 0).all()  # joints that cannot be are left alone


@pytest.mark.slow
@pytest.mark.parametrize("name", DESIGNS)
def test_module_goes_there_and_back(name: str, tmp_path: Path) -> None:
    body = write(tmp_path, DESIGNS[name])
    compiled(tmp_path, body + DRIVER + INCLUDED)
    check(tmp_path, DESIGNS[name])


@pytest.mark.slow
def test_halcompile_builds_it(tmp_path: Path) -> None:
    if shutil.which("halcompile") is None:
        pytest.skip("no halcompile here: it comes with Debian's linuxcnc-uspace-dev")
    write(tmp_path, APPENDIX_4)
    for name in HEADERS:
        (tmp_path / name).unlink()  # LinuxCNC's own
    command = ["halcompile", "--compile", "paminsakins.comp"]
    built = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True)
    assert built.returncode == 0, built.stdout + built.stderr
    (tmp_path / "kinematics.h").write_text(HEADERS["kinematics.h"])
    compiled(tmp_path, LOADED.replace("@DRIVER@", DRIVER))
    check(tmp_path, APPENDIX_4)


@pytest.mark.slow
def test_single_precision_has_no_module() -> None:
    assert "paminsakins.comp" in controller_kit(APPENDIX_4)
    assert "paminsakins.comp" not in controller_kit(APPENDIX_4, single=True)
