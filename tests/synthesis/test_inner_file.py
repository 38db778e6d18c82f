"""Motions, masses, counterweights and springs of case files."""

from __future__ import annotations

import numpy as np
import pytest

from paminsa_viz.balancing import MassRange, at_joint, on_bar, on_slider
from paminsa_viz.files.errors import DesignFileError
from paminsa_viz.synthesis.masses.case import MassFactor
from paminsa_viz.synthesis.search.case_file import EXAMPLES, read_case
from tests.synthesis.arch_case import arch_case

TEXT = EXAMPLES["arch"].read_text("utf-8")
MORE = """
[[synthesis.masses]]
mass = "links.b8"
factor = [0.5, 2]

[[synthesis.masses]]
mass = "joints.j9"
range_kg = [0.1, 0.2]
inertia_follows = false

[[synthesis.springs]]
first = { kind = "slider", height_m = 0.3 }
second = { kind = "joint", joint = 9 }
max_stiffness_N_per_m = 2000.0
free_length_m = [0.0, 0.2]

[[synthesis.springs]]
first = { kind = "bar", bar = "b4", joint = 9, beyond_m = 0.1 }
second = { kind = "guide", radius_m = 0.05, height_m = -0.2 }
max_stiffness_N_per_m = 100
"""


def test_the_arch_goes_there_and_back_about_the_center():
    inner = arch_case().inner
    (motion,) = inner.motions
    assert inner.from_center
    assert inner.motion_force == 300.0
    assert motion.t[-1] - motion.t[0] == pytest.approx(2.0)
    extent = np.ptp(motion.pose, axis=0)
    np.testing.assert_allclose(extent, [0.3, 0.0, np.radians(60.0), 0.1], atol=1e-3)
    np.testing.assert_allclose(motion.pose[0], motion.pose[-1], atol=1e-12)
    assert motion.pose[:, 3].max() == pytest.approx(0.05, abs=1e-3)
    assert [w.bar for w in inner.counterweights] == ["b8", "b3"]


def test_masses_and_springs_are_read():
    inner = read_case(TEXT + MORE, "arch.toml").inner
    assert inner.masses == (
        MassFactor("links.b8", 0.5, 2.0),
        MassRange("joints.j9", 0.1, 0.2, inertia_follows=False),
    )
    first, second = inner.springs
    assert (first.first, first.second) == (on_slider(0.3), at_joint(9))
    assert (first.max_stiffness, first.min_free_length, first.max_free_length) == (2000, 0, 0.2)
    assert second.first == on_bar("b4", 9, 0.1)
    assert (second.second.radius, second.second.height) == (0.05, -0.2)


def test_a_file_without_them_has_none():
    assert read_case(EXAMPLES["cylinder"].read_text("utf-8"), "cylinder.toml").inner is None


@pytest.mark.parametrize(
    ("old", "new", "match"),
    [
        ("duration_s = 1.0", "duration_s = -1.0", "are possible, not -1"),
        ("duration_s = 1.0", 'duration_s = "1"', "a number is needed"),
        ("arch_m = 0.1", "arc_m = 0.1", "no such key"),
        ("from = [-0.15, 0.0, ", "from = [-0.15, ", "4 numbers"),
        ("joint = 8", "joint = 5", "joints"),
        ("force_N = 300.0", "force_N = -1.0", "at least 0"),
        ('mass = "links.b8"', 'mass = "links.b99"', "no design value"),
        ('mass = "links.b8"', 'mass = "gravity"', "no mass of the design"),
        ("factor = [0.5, 2]", "factor = [2, 0.5]", "factors"),
        ('kind = "slider"', 'kind = "ceiling"', "ceiling"),
        ('objective = "peak_torque"', 'objective = "static_torque"', "M_p2 = 0"),
        ("[[synthesis.motions]]", "[[synthesis.motion]]", "did you mean motions"),
    ],
)
def test_wrong_entries_are_refused_with_the_reason(old, new, match):
    text = TEXT + MORE
    assert old in text
    with pytest.raises(DesignFileError, match=match):
        read_case(text.replace(old, new), "arch.toml")
