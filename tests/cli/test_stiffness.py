"""``stiffness``: the library's numbers, a reason where there are none, and refusals."""

from __future__ import annotations

import math
from functools import partial

import numpy as np
import pytest

from paminsa_viz.elastostatics.drive_stiffness import drive_modes
from paminsa_viz.elastostatics.stiffness import compensate, platform_stiffness, strain_shares
from paminsa_viz.elastostatics.vibration import robot_modes
from paminsa_viz.files.design_file import save_design
from paminsa_viz.model.design import APPENDIX_4
from paminsa_viz.model.drive import ACTUATORS
from paminsa_viz.model.singularity import singular_radius
from paminsa_viz.units import format_ascii
from tests.support import commands

run = partial(commands.run, "stiffness")
run_json = partial(commands.run_json, "stiffness")
POSE = ("--pose", "50", "20", "30", "-600")
AT = (0.05, 0.02, math.radians(30), -0.6)


@pytest.mark.parametrize("shear", [False, True])
def test_numbers_are_the_librarys(capsys, shear: bool) -> None:
    design = APPENDIX_4.vary({"elastic.b4_outer": 0.05, "elastic.drive_rotary": 2e4})
    save_design(design, "d.toml")
    words = ("--design", "d.toml", "--load", "5", "0", "-20", "0", "1", "2", "--payload", "3")
    found = run_json(capsys, *POSE, *words, *(["--shear"] if shear else []))
    assert list(found["compensation"]) == ["M1_rad", "M2_rad", "M3_rad", "M4_m"]
    loaded = design.vary({"payload.mass": 3.0})
    expected = platform_stiffness(loaded, AT, shear=shear)
    wrench = np.array([5.0, 0.0, -20 - 3 * 9.81, 0.0, 1.0, 2.0])
    np.testing.assert_allclose(found["wrench"], wrench)
    np.testing.assert_allclose(found["matrix"], expected.matrix)
    np.testing.assert_allclose(found["deflection"], expected.deflection(wrench))
    assert found["stiffness"]["x_N_per_m"] == pytest.approx(float(expected.along(0)))
    assert found["stiffness"]["tilt_Nm_per_rad"] == pytest.approx(float(expected.tilt))
    share = strain_shares(loaded, AT, wrench, shear=shear).share
    assert list(found["shares"]["load"].values()) == pytest.approx(share.tolist())


@pytest.mark.slow
def test_natural_frequencies_are_the_librarys(capsys) -> None:
    found = run_json(capsys, *POSE, "--payload", "10")["natural_frequencies_Hz"]
    design = APPENDIX_4.vary({"payload.mass": 10.0})
    assert found["whole robot"] == pytest.approx(robot_modes(design, AT).frequencies.tolist())
    assert found["drives alone"] == pytest.approx(drive_modes(design, AT).frequencies.tolist())
    _, out, _ = run(capsys, *POSE, "--payload", "10")
    first = next(line for line in out.splitlines() if line.startswith("1 "))
    assert first.split() == ["1", "6.207", "13.46"]
    save_design(design.vary({"elastic.drive_rotary": 1.0}), "weak.toml")
    lost = run_json(capsys, "--design", "weak.toml", "--pose", "80", "50", "35", "-500")
    assert lost["natural_frequencies_Hz"]["whole robot"] == [None] * 6


@pytest.mark.slow
def test_table_of_a_payload_and_of_unit_forces(capsys) -> None:
    code, out, err = run(capsys, *POSE, "--payload", "10")
    assert (code, err) == (0, "")
    assert "z [mm] -98.1 N -0.445" in " ".join(out.split())
    assert "a tilt of 0.113 mrad remains" in out
    design = APPENDIX_4.vary({"payload.mass": 10.0})
    back = compensate(design, np.array(AT)).actuators
    texts = map(format_ascii, back, (*["rad:mrad"] * 3, "m"), (3,) * 4)
    motors = ", ".join(f"{name} {text}" for name, text in zip(ACTUATORS, texts, strict=True))
    assert f"back with {motors};" in out
    assert "B4 53.0 %" in " ".join(out.split())
    code, out, _ = run(capsys, *POSE)
    assert "force x  force y  force z  moment z" in out
    assert "Deflection" not in out


def test_tubes_beside_appendix_4(capsys) -> None:
    """The inertias are 2 to 8 times those of slender tubes of the same mass."""
    bars = {bar["bar"]: bar for bar in run_json(capsys, "--sections")["bars"]}
    for bar, (length, mass, inertia) in {
        "B3": (0.42, 0.406, 0.02), "B4": (0.63, 0.672, 0.048),
        "B7": (0.21, 0.107, 0.003), "B8": (0.42, 0.403, 0.02),
    }.items():  # fmt: skip
        assert bars[bar]["length_m"] == length
        assert bars[bar]["mass_kg"] == pytest.approx(mass, rel=0.01)
        ratio = inertia / (mass * length**2 / 12)
        assert bars[bar]["slender_ratio"] == pytest.approx(ratio)
        assert 2 < ratio < 8
        assert 2 < bars[bar]["transverse_ratio"] < bars[bar]["slender_ratio"]
    assert "7.63" in run(capsys, "--sections")[1]


def test_singular_pose_has_a_reason_and_no_number(capsys) -> None:
    radius = 1e3 * float(singular_radius(APPENDIX_4.geometry, math.radians(30)))
    words = ("--pose", repr(radius), "0", "30", "-500")
    code, out, err = run(capsys, *words)
    assert (code, err) == (1, "")
    assert "no compliance; singular" in out
    code, out, _ = run(capsys, *words, "--json")
    assert code == 1
    assert '"reason": "singular' in out
    assert "stiffness" not in out
