"""``excite``: a motion within its limits, as a table that can be run."""

from __future__ import annotations

import numpy as np
import pytest

from paminsa_viz.files import save_design
from paminsa_viz.files.trajectory_table import read_trajectory
from paminsa_viz.model import APPENDIX_4, actuator_velocity, static_torques
from paminsa_viz.trajectory import preset_center
from paminsa_viz.units import rounded_to_side
from tests.support.commands import run, run_json
from tests.support.samples import resized

SHORT = ("--evaluations", "5", "--period", "6")


pytestmark = pytest.mark.usefixtures("few_random_motions")


@pytest.mark.slow
def test_written_motion_keeps_the_reported_limits(capsys) -> None:
    words = (*SHORT, "--out", "motion.csv", "--max-speed", "1.5", "--rate", "100")
    found = run_json("excite", capsys, *words)
    assert all(row["kept"] for row in found["limits"])
    motion = read_trajectory("motion.csv")
    assert motion.duration == pytest.approx(12.0)
    np.testing.assert_allclose(motion.velocity[[0, -1]], 0.0, atol=1e-9)
    speed = np.abs(actuator_velocity(APPENDIX_4, motion.pose, motion.velocity))[:, :3]
    largest = max(row["value"] for row in found["limits"][:3])
    assert speed.max() == pytest.approx(largest, rel=0.02)
    assert speed.max() <= 1.5
    code, out, _ = run("trajectory", capsys, "--file", "motion.csv")
    assert code == 0
    assert "The robot can run it" in out


@pytest.mark.slow
def test_table_for_people_names_every_limit(capsys) -> None:
    """Of a tenth of the lengths, beside which the least distance to a limit of reach is."""
    save_design(resized(APPENDIX_4, 0.1), "small.toml")
    code, out, err = run("excite", capsys, *SHORT, "--design", "small.toml")
    assert code == 0
    assert ">= 1 mm" in out
    assert err == "searching for up to 60 s ...\n"
    assert "of the best of 20 random motions" in out
    for name in ("speed of M1", "force of M4", "condition number", "distance to the limits"):
        assert name in out


@pytest.mark.slow
def test_wrong_limits_are_refused(capsys) -> None:
    code, out, err = run("excite", capsys, *SHORT, "--max-force", "50")
    assert (code, out) == (1, "")
    held = static_torques(APPENDIX_4, preset_center(APPENDIX_4.geometry))[3]
    times = f"{rounded_to_side(held / 50, 3, up=True):.3g} times as large"
    assert f"force of M4 is beyond its limit at rest there, {times}; raise it" in err


@pytest.mark.parametrize(
    ("rate", "needed"), [("1", "more than 1.667 Hz"), ("nan", "rate"), ("1e9", "rate")]
)
def test_rate_that_tells_the_motion_wrong_is_refused_before_the_search(
    capsys, rate: str, needed: str
) -> None:
    code, out, err = run("excite", capsys, *SHORT, "--harmonics", "5", "--rate", rate)
    assert (code, out) == (2, "")
    assert needed in err
    assert "searching" not in err
