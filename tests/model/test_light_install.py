"""What computes imports no viewer, plots or engine, and needs Numba for its speed alone."""

from __future__ import annotations

import subprocess
import sys

import pytest

HEAVY = (
    "viser", "websockets", "matplotlib", "contourpy", "plotly", "PIL", "mujoco", "pinocchio",
    "trimesh", "skimage", "fast_simplification", "jinja2", "rich", "tyro", "numba",
)  # fmt: skip

IMPORTS = f"""
import sys
import paminsa_viz.model, paminsa_viz.trajectory, paminsa_viz.balancing, paminsa_viz.quantities
import paminsa_viz.dimensions, paminsa_viz.clearance, paminsa_viz.elastostatics
import paminsa_viz.precision, paminsa_viz.actuation, paminsa_viz.identification
import paminsa_viz.files, paminsa_viz.studies, paminsa_viz.synthesis
print(*sorted(set({HEAVY}) & set(sys.modules)))
"""

NOT_INSTALLED = """
import sys
sys.modules["numba"] = None
"""

NOT_LOADED = """
import sys

class Unloadable:
    def find_spec(self, name, path, target=None):
        if name == "numba":
            raise OSError("could not find/load shared object file 'libllvmlite.so'")

sys.meta_path.insert(0, Unloadable())
"""
"""As where too little memory is left for LLVM, or its folder may hold no programs."""

WITHOUT_NUMBA = """
import numpy as np
from paminsa_viz.clearance import clearance, kernels
from paminsa_viz.model import APPENDIX_4, backend, inverse_dynamics, static_torques
from paminsa_viz.model.reach import home_pose
from paminsa_viz.trajectory import PRESET, analyze

pose = np.tile(home_pose(APPENDIX_4.geometry), (backend.WORTH_LOADING + 1, 1))
torque = static_torques(APPENDIX_4, pose)
np.testing.assert_array_equal(torque, np.broadcast_to(torque[0], torque.shape))
found = inverse_dynamics(APPENDIX_4, pose, np.zeros(4), np.zeros(4))
np.testing.assert_allclose(found.torque[-1], torque[0], atol=1e-9)
backend.compile_now()
assert not backend.is_compiled()
analyze(APPENDIX_4, PRESET["circle"].build(APPENDIX_4.geometry).sample())
assert np.isfinite(clearance(APPENDIX_4, pose[: kernels.WORTH]).least).all()
"""


def run(code: str) -> str:
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stderr
    return done.stdout.strip()


@pytest.mark.slow
def test_rooms_that_compute_import_no_viewer_no_plots_and_no_engine() -> None:
    assert run(IMPORTS) == ""


@pytest.mark.slow
@pytest.mark.parametrize("why", [NOT_INSTALLED, NOT_LOADED], ids=["not installed", "not loaded"])
def test_any_number_of_poses_without_numba(why: str) -> None:
    run(why + WITHOUT_NUMBA)
