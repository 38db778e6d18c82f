"""Tables of trajectories: units in the header, faults by row and column, and back again."""

from __future__ import annotations

import io
import json
import re
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from paminsa_viz.elastostatics.joint_forces import JOINTS, joint_forces
from paminsa_viz.errors import TableFileError
from paminsa_viz.files.columns import (
    ACCELERATION,
    ENERGIES,
    LOAD,
    POSE,
    RESULTS,
    TORQUES,
    TRAJECTORY,
    VELOCITY,
    WANTED,
    match_columns,
    part_columns,
)
from paminsa_viz.files.loads_table import joint_table
from paminsa_viz.files.logs import parse_log, simulated_log_table
from paminsa_viz.files.tables import table_csv, table_npz
from paminsa_viz.files.trajectory_table import (
    analysis_table,
    parse_trajectory,
    read_trajectory,
    simulation_table,
)
from paminsa_viz.model import (
    APPENDIX_4,
    Counterweight,
    Drive,
    KneeBranch,
    LoadFrame,
    Misprint,
)
from paminsa_viz.plots.map_table import map_table
from paminsa_viz.plots.map_values import map_data, workspace_field
from paminsa_viz.trajectory import (
    Controller,
    ControlMode,
    Trajectory,
    analyze,
    point_to_point,
    simulate,
)
from paminsa_viz.trajectory.sampled import Locus, Passage
from paminsa_viz.units import COLUMN_UNITS
from tests.support.samples import with_knee

HEAD = "t_s,x_m,y_m,theta_rad,z_m"
ROWS = "0,0,0,0,-0.5\n0.5,0.01,0,0,-0.5\n"
HOME = np.array([0.0, 0.0, 0.0, -0.5])
SAMPLES = point_to_point(HOME, [0.05, 0.02, 0.3, -0.45], 0.4, name="a move").sample(100)
LEAVING = point_to_point(HOME, [0.3, 0.0, 0.0, -0.5], 0.4).sample(100)


def parse(text: str, **options) -> Trajectory:
    return parse_trajectory(io.StringIO(text, newline=""), "in.csv", **options)


@st.composite
def tables(draw):
    """A header with a unit for every column, in any order and spelling, and its numbers in SI."""
    names = ["t", "x", "y", "theta", "z"]
    groups = draw(st.integers(0, 2))
    names += [["vx", "vy", "omega", "vz"], ["ax", "ay", "alpha", "az"]][0] if groups else []
    names += ["ax", "ay", "alpha", "az"] if groups == 2 else []
    names = draw(st.permutations(names))
    header, factors = [], []
    for name in names:
        si = {"t": "s", "theta": "rad", "omega": "rad", "alpha": "rad"}.get(name, "m")
        per = {"v": "_s", "o": "_s", "a": "_s2"}.get(name[0], "")
        base = draw(st.sampled_from(sorted(COLUMN_UNITS[si])))
        unit = base + per
        pretty = unit.replace("_", "/").replace("s2", "s^2")
        pretty = draw(st.sampled_from([pretty, pretty.replace("deg", "°").replace("^2", "²")]))
        header.append(draw(st.sampled_from([f"{name}_{unit}", f" {name} [{pretty}] "])))
        factors.append(COLUMN_UNITS[si][base])
    count = draw(st.integers(2, 9))
    numbers = np.random.default_rng(draw(st.integers(0, 99))).uniform(-1, 1, (count, len(names)))
    numbers[:, names.index("t")] = np.arange(count) / 7
    return names, header, np.array(factors), numbers


@given(tables(), st.sampled_from(["", "# a\n# b: c\n"]), st.sampled_from(["\n", "\r\n"]))
def test_every_cell_arrives_in_its_unit(table, comment, end) -> None:
    names, header, factors, numbers = table
    lines = [",".join(header), *(",".join(map(repr, row)) for row in (numbers / factors).tolist())]
    made = parse(comment.replace("\n", end) + end.join(lines) + end)
    columns = {
        "x": made.pose, "y": made.pose, "theta": made.pose, "z": made.pose,
        "vx": made.velocity, "vy": made.velocity, "omega": made.velocity, "vz": made.velocity,
        "ax": made.acceleration, "ay": made.acceleration, "alpha": made.acceleration,
        "az": made.acceleration,
    }  # fmt: skip
    order = list(columns)
    for name, values in zip(names, numbers.T, strict=True):
        found = made.t if name == "t" else columns[name][:, order.index(name) % 4]
        np.testing.assert_allclose(found, values, rtol=1e-12, atol=1e-15)


def test_name_and_rest_of_a_file_that_is_read(tmp_path) -> None:
    path = tmp_path / "my run.csv"
    path.write_text(f"{HEAD}\n{ROWS}1,0.02,0.01,0.1,-0.45\n")
    free, rest = read_trajectory(path), read_trajectory(path, rest=True, name="other")
    assert (free.name, rest.name) == ("my run", "other")
    assert np.abs(free.velocity[0]).max() > 1e-3
    np.testing.assert_allclose(rest.velocity[[0, -1]], 0.0, atol=1e-12)


@pytest.mark.parametrize("samples", [SAMPLES, LEAVING], ids=["possible", "leaving"])
@pytest.mark.parametrize("knee", KneeBranch)
def test_a_written_trajectory_comes_back(samples, knee, tmp_path) -> None:
    found = analyze(with_knee(APPENDIX_4, knee), samples)
    path = tmp_path / "out.csv"
    path.write_bytes(table_csv(analysis_table(found)))
    back = read_trajectory(path)
    for name in ("t", "pose", "velocity", "acceleration"):
        np.testing.assert_array_equal(getattr(back, name), getattr(samples, name))
    assert back.notes == ()


def test_planned_crossings_come_back(tmp_path) -> None:
    planned = (Passage(0.125, Locus.CIRCLE), Passage(0.3, Locus.ROTATION))
    text = table_csv(analysis_table(analyze(APPENDIX_4, replace(SAMPLES, passages=planned))))
    assert parse(text.decode()).passages == planned
    later = re.sub(r"^0\.0,", "-0.01,", text.decode(), flags=re.MULTILINE)
    assert [item.t for item in parse(later).passages] == pytest.approx([0.135, 0.31])


@pytest.mark.parametrize(
    ("value", "said"),
    [
        ("0.2 s, circle", "planned crossing 1: “0.2 s, singular circle or singular rotation” is"),
        ("soon, singular circle", "is possible, not 'soon, singular circle'"),
        ("", "is possible, not ''"),
        ("9 s, singular circle", "passages: times between 0 and 0.5 s are possible, not 9.0"),
        ("nan s, singular circle", "times between 0 and 0.5 s are possible, not nan"),
    ],
)
def test_a_crossing_that_is_none_is_refused(value: str, said: str) -> None:
    with pytest.raises(TableFileError, match=re.escape(said)):
        parse(f"# planned crossing 1: {value}\n{HEAD}\n{ROWS}")


def test_headers_state_all_that_numbers_follow_from() -> None:
    changes = {"elastic.b4_outer": 0.05, "tolerances.bar": 1e-5, "load.force_x": 3.0}
    design = replace(
        APPENDIX_4.vary(changes),
        counterweights=(Counterweight("b3", 7, 0.1, 2.5),),
        drives=(None, None, Drive("motor", gear_ratio=50.0, coulomb=0.004), None),
    )
    design = replace(design, load=replace(design.load, frame=LoadFrame.PLATFORM))
    pose = np.array([0.0, 0.0, 0.0, -0.5])
    maps = map_data(workspace_field(design.geometry, *pose[2:], 3), design, pose)
    tables = (
        analysis_table(analyze(design, LEAVING)), joint_table(joint_forces(design, pose), pose),
        map_table(maps),
    )  # fmt: skip
    for head in (table.provenance for table in tables):
        assert float(head["design elastic.b4_outer [m]"]) == 0.05
        assert float(head["design tolerances.bar [m]"]) == 1e-5
        assert head["design load.frame"] == "platform"
        assert head["design counterweights.0"] == "2.5 kg on B3, 100 mm beyond joint 7"
        assert head["design drives.M3"] == "motor, 50:1"
        assert float(head["design drives.M3.gear_ratio"]) == 50.0
        assert float(head["design drives.M3.coulomb_Nm"]) == 0.004
        assert sum("drives.M3" in key for key in head) == 3
        assert not any(name in key for key in head for name in ("drives.M1", "leg1", "accuracy"))


def test_a_table_of_joints_has_each_joint_of_each_leg_with_its_own_forces() -> None:
    pose = np.array([0.05, 0.02, 0.3, -0.5])
    forces = joint_forces(APPENDIX_4, pose)
    columns = joint_table(forces, pose).columns
    directions = [columns[f"{name}_N"] for name in ("radial", "tangential", "vertical")]
    legs, keys = columns["leg"], columns["joint"]
    assert len(set(zip(legs, keys, strict=True))) == len(legs) > 15
    assert set(legs) == {"1", "2", "3"}
    for row, (leg, key) in enumerate(zip(legs, keys, strict=True)):
        index = [joint.key for joint in JOINTS].index(key)
        found = [column[row] for column in directions]
        np.testing.assert_array_equal(found, forces.force[int(leg) - 1, index])
        assert columns["moment_Nm"][row] == forces.moment[int(leg) - 1, index]


def test_columns_and_provenance_of_a_written_table() -> None:
    noted = replace(LEAVING, notes=("one", "other"))
    found = analyze(APPENDIX_4, noted, misprints=Misprint.APP3_MC4)
    table = analysis_table(found)
    loads = {*LOAD, *part_columns("load")}  # only where there is one
    simulated = {*WANTED, *ENERGIES}
    assert set(table.columns) == {*TRAJECTORY.columns, *RESULTS} - loads - simulated
    text = table_csv(table).decode()
    comments = [line for line in text.splitlines() if line.startswith("# ")]
    head, *rows = [line.split(",") for line in text.splitlines() if not line.startswith("#")]
    assert len(rows) == LEAVING.size
    head_values = dict(line[2:].split(": ", 1) for line in comments)
    assert head_values["design"] == "Appendix 4"
    assert (head_values["note 1"], head_values["note 2"]) == noted.notes
    assert head_values["formulas"] == "as published: APP3_MC4"
    assert head_values["design links.b3 [kg]"] == "0.406"
    assert "singular pose" in head_values["first failure"]
    for row, torque, word in zip(rows, found.torque, found.check.words(), strict=True):
        cells = [row[head.index(name)] for name in TORQUES]
        assert row[-1] == word
        if word == "ok":
            assert [float(cell) for cell in cells] == torque.tolist()
        else:
            assert cells == [""] * 4
    assert match_columns(tuple(head), TRAJECTORY, "out.csv", 1)[0].name == "t_s"


def test_npz_holds_the_same_numbers_as_csv() -> None:
    found = analyze(APPENDIX_4, SAMPLES)
    table = analysis_table(found)
    data = np.load(io.BytesIO(table_npz(table)))
    for name, column in table.columns.items():
        np.testing.assert_array_equal(data[name], column)
    np.testing.assert_array_equal(
        np.stack([data[name] for name in (*POSE, *VELOCITY, *ACCELERATION)], axis=1),
        np.hstack([SAMPLES.pose, SAMPLES.velocity, SAMPLES.acceleration]),
    )
    assert data["status"].tolist() == ["ok"] * SAMPLES.size
    assert json.loads(str(data["provenance"])) == dict(table.provenance)


def test_a_simulation_as_a_table() -> None:
    found = simulate(APPENDIX_4, SAMPLES, controller=Controller(ControlMode.FEED_FORWARD))
    table = simulation_table(found)
    np.testing.assert_array_equal(table.columns["wanted_x_m"], SAMPLES.pose[:, 0])
    np.testing.assert_array_equal(table.columns["f4_N"], found.torque[:, 3])
    for header in (table.provenance, simulated_log_table(found).provenance):
        assert (header["trajectory"], header["kind"]) == (SAMPLES.name, SAMPLES.kind)
    assert table.provenance["controller"] == "feed-forward"
    assert table.provenance["stopped"] == "at the end"
    assert len(table_csv(table).decode().splitlines()) == len(table.provenance) + 1 + SAMPLES.size
    assert "status" not in np.load(io.BytesIO(table_npz(table)))
    back = parse_trajectory(io.StringIO(table_csv(table).decode(), newline=""), "run.csv")
    np.testing.assert_array_equal(back.t, found.t)
    np.testing.assert_array_equal(back.pose, found.pose)
    np.testing.assert_array_equal(back.velocity, found.velocity)


def test_hostile_names_stay_on_one_line() -> None:
    samples = Trajectory(
        SAMPLES.t, SAMPLES.pose, SAMPLES.velocity, SAMPLES.acceleration, "a\nt_s,b"
    )
    found = analyze(APPENDIX_4.vary({}), samples)
    text = table_csv(analysis_table(found)).decode()
    assert parse(text).size == samples.size
    simulated = simulate(APPENDIX_4, samples)
    assert parse(table_csv(simulation_table(simulated)).decode()).size == samples.size
    log = table_csv(simulated_log_table(simulated)).decode()
    assert parse_log(io.StringIO(log, newline=""), "log.csv").t.size == samples.size


def test_loads_are_read_and_written_with_any_of_their_columns() -> None:
    head = f"{HEAD},Fx_N,Fz [kN],Mz [N m]"
    rows = "0,0,0,0,-0.5,10,-0.2,1\n0.5,0.01,0,0,-0.5,20,-0.1,3\n"
    motion = parse(f"{head}\n{rows}")
    assert motion.load is not None
    np.testing.assert_allclose(motion.load, [[10, 0, -200, 0, 0, 1], [20, 0, -100, 0, 0, 3]])
    assert parse(f"{HEAD}\n{ROWS}").load is None
    table = analysis_table(analyze(APPENDIX_4, motion))
    assert "tau1_load_Nm" in table.columns
    again = parse(table_csv(table).decode())
    np.testing.assert_array_equal(again.load, motion.load)
    plain = analysis_table(analyze(APPENDIX_4, SAMPLES)).columns
    assert not [name for name in plain if "load" in name or name.startswith("F")]
    with pytest.raises(TableFileError, match="write Fx_N or Fx_kN"):
        parse(f"{HEAD},Fx\n{ROWS}")
