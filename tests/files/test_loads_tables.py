"""Tables of joint forces and bar loads: every cell is where its joint, bar and leg are."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from paminsa_viz.elastostatics.bar_loads import bar_loads
from paminsa_viz.elastostatics.joint_forces import JOINTS, NEEDS_STIFFNESS, joint_forces
from paminsa_viz.elastostatics.motion_loads import MotionLoads, motion_loads
from paminsa_viz.files.loads_table import (
    LEGS,
    MotionInstant,
    bar_table,
    bearing_table,
    joint_table,
    motion_loads_table,
)
from paminsa_viz.files.tables import DataTable
from paminsa_viz.model import APPENDIX_4
from paminsa_viz.model.elastic import BARS
from paminsa_viz.trajectory import PRESET, analyze

POSE = np.array([0.05, -0.03, 0.2, -0.5])
FORCES = joint_forces(APPENDIX_4, POSE)


@pytest.fixture(scope="module")
def moved() -> MotionLoads:
    trajectory = PRESET["arch"].build(APPENDIX_4.geometry).sample(40.0)
    found = motion_loads(analyze(APPENDIX_4, trajectory))
    assert found is not None
    return found


def by_leg_and_joint(table: DataTable) -> dict[tuple[str, str], dict[str, Any]]:
    """Rows by leg and joint."""
    rows = [
        dict(zip(table.columns, row, strict=True))
        for row in zip(*table.columns.values(), strict=True)
    ]
    found = {(str(row["leg"]), str(row["joint"])): row for row in rows}
    assert len(found) == len(rows) == 3 * len(JOINTS)
    return found


@pytest.mark.parametrize("known", [False, True])
def test_a_pose_has_a_row_for_each_joint_of_each_leg(known: bool) -> None:
    sideways = np.arange(30.0).reshape(3, 10) if known else None
    table = joint_table(FORCES, POSE, sideways)
    for (leg, key), row in by_leg_and_joint(table).items():
        radial, tangential, vertical = FORCES.of(key)[int(leg) - 1]
        number = [joint.key for joint in JOINTS].index(key)
        joint = JOINTS[number]
        assert (row["on"], row["by"]) == (joint.on, joint.by)
        assert (row["radial_N"], row["vertical_N"]) == (radial, vertical)
        across = tangential if sideways is None else sideways[int(leg) - 1, number]
        np.testing.assert_equal(row["tangential_N"], across)
        np.testing.assert_equal(row["moment_Nm"], FORCES.moment[int(leg) - 1, number])
    assert (table.provenance["tangential"] == NEEDS_STIFFNESS) is not known
    assert list(map(float, table.provenance["pose [m, m, rad, m]"].split())) == POSE.tolist()


@pytest.mark.parametrize("bar", ["b4", "b1"])
def test_a_bar_has_its_sections_from_end_to_end(bar: str) -> None:
    table = bar_table(FORCES, POSE, bar)
    loads = bar_loads(FORCES, bar)
    s = table.columns["s_m"]
    assert (s[0], s[-1], len(s)) == (0.0, pytest.approx(loads.length), 101)
    np.testing.assert_allclose(np.diff(s), s[1])
    for leg in LEGS:
        columns = [table.columns[f"leg{leg + 1}_{name}"] for name in ("N_N", "V_N", "M_Nm")]
        np.testing.assert_array_equal(np.transpose(columns), loads.at(s)[leg])
    assert table.provenance["bar"] == bar.upper()


def test_a_pose_says_of_which_instant_of_a_motion_it_is() -> None:
    at = MotionInstant(
        "arch", 0.2, (0.1, 0.0, -0.2, 0.3), (1.0, 2.0, 3.0, 4.0), (5.0,) + 5 * (0.0,)
    )
    for make in (
        lambda at: joint_table(FORCES, POSE, at=at),
        lambda at: bar_table(FORCES, POSE, "b4", at),
    ):
        assert make(None).provenance["motion"] == "at rest"
        head = make(at).provenance
        assert head["motion"] == "arch"
        assert head["time [s]"] == "0.2"
        assert head["velocity [m/s, m/s, rad/s, m/s]"] == "0.1 0.0 -0.2 0.3"
        assert head["acceleration [m/s^2, m/s^2, rad/s^2, m/s^2]"] == "1.0 2.0 3.0 4.0"
        assert head["load of the motion [N, N, N, N m, N m, N m]"].startswith("5.0 0.0")


def test_a_motion_has_its_loads_at_every_sample(moved: MotionLoads) -> None:
    table = motion_loads_table(moved)
    expected = {"t_s": moved.trajectory.t, "axial_N": moved.forces.axial}
    for leg in LEGS:
        for joint in JOINTS:
            radial, tangential, vertical = moved.forces.of(joint.key)[:, leg].T
            name = f"leg{leg + 1}_{joint.key}"
            expected |= {f"{name}_radial_N": radial, f"{name}_vertical_N": vertical}
            if joint.key == "5":
                expected[f"{name}_tangential_N"] = tangential
            if joint.key in ("m", "2"):
                moment = moved.forces.moment[:, leg, JOINTS.index(joint)]
                expected[f"{name}_moment_Nm"] = moment
        for number, bar in enumerate(BARS):
            largest = bar_loads(moved.forces, bar).extremes()[:, leg]
            names = [f"leg{leg + 1}_{bar}_{part}" for part in ("N_N", "V_N", "M_Nm")]
            expected |= dict(zip(names, largest.T, strict=True))
            expected[f"leg{leg + 1}_{bar}_utilization"] = moved.utilization[:, leg, number]
    assert set(table.columns) == set(expected)
    for name, values in expected.items():
        np.testing.assert_array_equal(table.columns[name], values, err_msg=name)
    assert table.provenance["trajectory"] == moved.trajectory.name


def test_bearings_have_what_a_catalog_asks_for(moved: MotionLoads) -> None:
    for (leg, key), row in by_leg_and_joint(bearing_table(moved)).items():
        number = [joint.key for joint in JOINTS].index(key)
        place = int(leg) - 1, number
        size = np.linalg.norm(np.nan_to_num(moved.forces.of(key)[:, place[0]]), axis=-1)
        assert row["peak_N"] == pytest.approx(size.max(), rel=1e-12)
        assert row["peak_t_s"] == moved.trajectory.t[size.argmax()]
        assert row["rms_N"] == moved.rms[place] <= row["peak_N"]
        np.testing.assert_equal(row["equivalent_N"], moved.equivalent[place])
        assert row["travel"] == moved.travel[place]
        assert row["travel_unit"] == ("m" if key == "guide" else "rad")
