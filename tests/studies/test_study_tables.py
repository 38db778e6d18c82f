"""Tables of a study: their rows, their bytes from anywhere, what they are resumed with."""

from __future__ import annotations

import csv
import hashlib
import os
import struct
from concurrent.futures import ThreadPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from paminsa_viz.model import (
    APPENDIX_4,
    Counterweight,
    InvalidInput,
    KneeBranch,
    LoadCase,
    LoadFrame,
)
from paminsa_viz.model.accuracy import equal_legs_note
from paminsa_viz.model.drive import Drive
from paminsa_viz.studies import (
    DesignAxis,
    DesignGrid,
    Workers,
    cluster,
    measure_design,
    processes,
    run_study,
)
from paminsa_viz.studies.metrics import samples_hash
from paminsa_viz.studies.running import PART, Extremes, WorkersLost
from paminsa_viz.studies.study import SAMPLE_WORK
from paminsa_viz.trajectory import Trajectory
from paminsa_viz.trajectory.sampled import Locus, Passage
from tests.studies.studies import GRID, MOTION, MOVED, NAMES, RANDOM, SMALL


@pytest.fixture(scope="module")
def expected(tmp_path_factory) -> bytes:
    path = tmp_path_factory.mktemp("study") / "a.csv"
    summary = run_study(MOVED, path, command="test")
    assert (summary.rows, summary.found) == (40, 0)
    return path.read_bytes()


def read(path) -> list[dict[str, str]]:
    lines = [line for line in path.read_text().splitlines() if not line.startswith("#")]
    return list(csv.DictReader(lines))


def test_the_head_says_which_design_the_added_mass_is_counted_from(expected) -> None:
    named = "mass beyond that of the design that the others are made from"
    assert f"added_mass_kg: {named}" in expected.decode()


def test_a_row_reads_back_as_the_numbers_it_was_made_of(tmp_path) -> None:
    run_study(SMALL, tmp_path / "a.csv")
    rows = read(tmp_path / "a.csv")
    assert [row["row"] for row in rows] == [str(i) for i in range(6)]
    mass = APPENDIX_4.value
    for i, row in enumerate(rows):
        b3, l4 = GRID.values(i)
        assert (float(row["links.b3 [kg]"]), float(row["geometry.coupler_length [m]"])) == (b3, l4)
        design = APPENDIX_4.vary({"links.b3": b3, "geometry.coupler_length": l4})
        found = measure_design(design, SMALL.region)
        torque = found[NAMES.index("peak_torque_Nm")]
        assert row["peak_torque_Nm"] == ("" if np.isnan(torque) else repr(torque))
        assert float(row["added_mass_kg"]) == pytest.approx(3 * (b3 - mass("links.b3")))


@pytest.mark.slow
def test_the_table_is_the_same_from_threads(expected, tmp_path) -> None:
    with ThreadPoolExecutor(3) as pool:
        run_study(MOVED, tmp_path / "threads.csv", Workers(pool, 3), command="test")
    assert (tmp_path / "threads.csv").read_bytes() == expected


@pytest.mark.slow
def test_the_table_is_the_same_from_processes(expected, tmp_path) -> None:
    with processes(2) as workers:
        run_study(MOVED, tmp_path / "processes.csv", workers, command="test")
    assert (tmp_path / "processes.csv").read_bytes() == expected


@pytest.mark.slow
def test_the_table_is_the_same_from_a_cluster(expected, tmp_path) -> None:
    distributed = pytest.importorskip("distributed")
    path = tmp_path / "cluster.csv"
    with (
        distributed.LocalCluster(
            n_workers=1, threads_per_worker=2, processes=False, dashboard_address=None
        ) as local,
        cluster(local.scheduler_address) as workers,
    ):
        assert workers.count == 2
        run_study(MOVED, path, workers, command="test")
        with pytest.raises(ValueError, match="No client"):  # those of other programs are left alone
            distributed.default_client()
        assert workers.executor is not None
        drawn = [workers.executor.submit(os.urandom, 8).result() for _ in range(2)]
        assert drawn[0] != drawn[1]  # a task is not taken for one like it
        with pytest.raises(ZeroDivisionError):
            workers.executor.submit(failing, tmp_path / "tries").result()
        assert (tmp_path / "tries").read_text() == "xxx"  # what fails is begun twice again
    assert path.read_bytes() == expected


def failing(tries: Path) -> float:
    with tries.open("a") as file:
        file.write("x")
    return 1 / 0


@pytest.mark.slow
def test_a_cluster_without_workers_is_refused() -> None:
    distributed = pytest.importorskip("distributed")
    with (
        distributed.LocalCluster(n_workers=0, processes=False, dashboard_address=None) as local,
        pytest.raises(InvalidInput, match="has no workers"),
        cluster(local.scheduler_address),
    ):
        pass


@pytest.mark.slow
@pytest.mark.parametrize("address", ["tcp://127.0.0.1:9", "nonsense", "http://x"])
def test_missing_scheduler_is_named(monkeypatch, address) -> None:
    pytest.importorskip("distributed")
    monkeypatch.setattr("paminsa_viz.studies.executors.CONNECT_TIMEOUT", 0.5)
    with pytest.raises(InvalidInput, match=f"no scheduler answers at {address}"), cluster(address):
        pass


@pytest.mark.slow
def test_an_error_in_the_middle_leaves_a_table_to_go_on_with(expected, tmp_path) -> None:
    path = tmp_path / "a.csv"

    def give_up(done, *, summary) -> None:
        assert done == summary.rows / MOVED.size
        if summary.rows >= 16:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        run_study(MOVED, path, command="test", progress=give_up)
    assert len(read(path)) == 16
    assert run_study(MOVED, path).found == 16
    assert path.read_bytes() == expected


@pytest.mark.slow
def test_the_summary_of_a_finished_table_is_that_of_its_rows(expected, tmp_path) -> None:
    path = tmp_path / "a.csv"
    path.write_bytes(expected)
    summary = run_study(MOVED, path)
    static = [row for row in read(path) if row["status"] == "ok"]
    moving = [row for row in read(path) if row["motion"] == "ok"]
    assert summary.found == 40
    assert summary.status["ok"] == len(static) > 5
    assert summary.motion["ok"] == len(moving) > 5
    assert len(static) != len(moving) < 40
    assert sum(summary.status.values()) == sum(summary.motion.values()) == 40
    for name, found in summary.extremes.items():
        rows = moving if name.startswith("motion") else static
        values = {int(row["row"]): float(row[name]) for row in rows if row[name]}
        assert found.least == min(values.values()) == values[found.least_row]
        assert found.largest == max(values.values()) == values[found.largest_row]


@pytest.mark.parametrize("parts", [0, 2])
def test_a_run_ends_where_its_progress_says_so(parts: int, tmp_path) -> None:
    seen: list[int] = []

    def enough(done: float, *, summary) -> bool:
        assert done == summary.rows / study.size
        seen.append(summary.rows)
        return len(seen) > parts

    study = replace(RANDOM, trajectory=None)
    summary = run_study(study, tmp_path / "a.csv", progress=enough)
    assert seen == [PART * part for part in range(parts + 1)]
    assert summary.rows == len(read(tmp_path / "a.csv")) == PART * parts
    assert run_study(study, tmp_path / "a.csv", progress=enough).found == PART * parts


def test_workers_that_die_are_named_and_their_rows_are_left_to_be_resumed(tmp_path) -> None:
    class Dying(Workers):
        def in_order(self, function, items):
            for number, item in enumerate(items):
                if number == 1:
                    raise BrokenProcessPool
                yield function(item)

    with pytest.raises(WorkersLost, match=rf"{PART} of 40 rows are written, and the same command"):
        run_study(replace(RANDOM, trajectory=None), tmp_path / "a.csv", Dying())
    assert len(read(tmp_path / "a.csv")) == PART


def test_extremes_are_of_the_first_rows_that_have_them() -> None:
    found = Extremes()
    assert (found.least_row, found.largest_row) == (-1, -1)
    assert np.isnan([found.least, found.largest]).all()
    for row, value in ((3, 2.0), (5, 2.0), (7, -1.0), (8, -1.0), (9, 2.5), (11, 2.5)):
        found.add(row, value)
    assert found == Extremes(-1.0, 2.5, 7, 9)


def test_the_work_of_a_study_is_that_of_its_poses_and_samples() -> None:
    for study in (SMALL, MOVED):
        assert replace(study, trajectory=None).work == study.size * study.region.grid().size
    samples = MOTION.size
    more = MOVED.work - replace(MOVED, trajectory=None).work
    assert more == SAMPLE_WORK * samples * MOVED.size


def test_the_head_of_a_table_says_what_the_rows_follow_from() -> None:
    head = MOVED.provenance("paminsa-viz sweep")
    assert (head["command"], head["rows"], head["designs"]) == (
        "paminsa-viz sweep",
        "40",
        "random, seed 1",
    )
    assert head["vary geometry.base_radius [m]"] == "0.15 to 0.7"
    assert head["scale bars"] == "no"
    region = MOVED.region
    assert list(map(float, head["region theta [rad]"].split())) == list(region.theta)
    assert list(map(float, head["region z [m]"].split())) == list(region.z)
    assert (float(head["region radius [m]"]), int(head["region cells"])) == (region.radius, 8)
    assert float(head["largest condition number"]) == region.max_condition
    assert head["motion"].endswith(f"{MOTION.size} samples in {MOTION.duration:g} s")
    head = replace(SMALL, scale_bars=True).provenance()
    assert (head["designs"], head["scale bars"]) == ("grid", "yes")
    assert head["vary geometry.coupler_length [m]"] == "3 values, 0.1 to 0.63"
    assert DesignAxis("links.b3", (1.0,)).words == "1 value, 1.0 to 1.0"
    assert "command" not in head
    assert "motion" not in head
    assert all(metric.meaning == head[metric.column] for metric in SMALL.metrics)
    pushed = SMALL.design.vary({"load.force_x": 4.0})
    for design in (SMALL.design, pushed):
        rest = replace(SMALL, design=design).provenance()
        assert rest["design links.b3 [kg]"] == repr(design.links.b3)
        assert rest["design load.force_x [N]"] == repr(design.load.force_x)


def test_a_table_of_equal_legs_says_so_for_a_design_with_deviations() -> None:
    """An index of errors by tolerances follows the deviations of single legs."""
    assert "legs" not in SMALL.provenance()
    study = replace(SMALL, design=APPENDIX_4.vary({"leg2.shaft": 2e-4}))
    assert study.provenance()["legs"] == equal_legs_note(study.design.deviations)
    assert "legs" not in replace(study, indices=("tolerance_x",)).provenance()


def test_every_difference_makes_another_table() -> None:
    crossings = [
        Passage(0.1, Locus.CIRCLE),
        Passage(0.1, Locus.ROTATION),
        Passage(0.2, Locus.CIRCLE),
    ]
    others = [
        replace(SMALL, design=APPENDIX_4.vary({"links.b4": 0.5})),
        replace(SMALL, design=replace(APPENDIX_4, counterweights=(Counterweight("b3", 7, 0.1),))),
        replace(SMALL, region=replace(SMALL.region, cells=9)),
        replace(SMALL, design=APPENDIX_4.with_knee(KneeBranch.UPPER)),
        replace(SMALL, scale_bars=True),
        replace(SMALL, variation=DesignGrid(GRID.axes[:1])),
        RANDOM,
        replace(RANDOM, variation=replace(RANDOM.variation, seed=4)),
        replace(SMALL, trajectory=MOTION),
        replace(SMALL, trajectory=replace(MOTION, velocity=2 * MOTION.velocity)),
        replace(SMALL, trajectory=replace(MOTION, load=np.zeros((MOTION.size, 6)))),
        replace(SMALL, trajectory=replace(MOTION, load=np.ones((MOTION.size, 6)))),
        *(replace(SMALL, trajectory=replace(MOTION, passages=(at,))) for at in crossings),
        *(
            replace(SMALL, design=replace(APPENDIX_4, load=LoadCase(force_x=1.0, frame=frame)))
            for frame in LoadFrame
        ),
        replace(SMALL, design=replace(APPENDIX_4, drives=(Drive("d"), None, None, None))),
        replace(SMALL, design=replace(APPENDIX_4, drives=(None, Drive("d"), None, None))),
        replace(SMALL, design=APPENDIX_4.vary({"accuracy.resolution_rotary": 1e-3})),
        replace(SMALL, design=APPENDIX_4.vary({"accuracy.resolution_rotary": 2e-3})),
    ]
    marks = {study.fingerprint for study in (SMALL, *others)}
    assert len(marks) == 1 + len(others)
    same = replace(SMALL, design=replace(APPENDIX_4, name="other"))
    assert same.fingerprint == SMALL.fingerprint


@given(row=st.integers(0, MOTION.size - 2), column=st.integers(0, 12))
def test_the_last_bit_of_any_sample_makes_another_motion(row, column) -> None:
    samples = np.column_stack([MOTION.t, MOTION.pose, MOTION.velocity, MOTION.acceleration])
    samples[row, column] = np.nextafter(samples[row, column], np.inf)
    t, *states = np.split(samples, [1, 5, 9], axis=1)
    changed = Trajectory(t[:, 0], *states, name=MOTION.name)
    assert samples_hash(changed) != samples_hash(MOTION)
    assert samples_hash(replace(MOTION, name="other")) == samples_hash(MOTION)


def test_a_motion_is_known_by_its_samples_as_doubles_of_eight_bytes() -> None:
    parts = (MOTION.t, MOTION.pose, MOTION.velocity, MOTION.acceleration)
    doubles = [struct.pack("<d", number) for part in parts for number in part.ravel().tolist()]
    assert samples_hash(MOTION) == hashlib.sha256(b"".join(doubles)).hexdigest()[:32]


def test_a_later_version_goes_on_with_a_table() -> None:
    """The mark of a study follows from the study alone; this one is of version 0.1.0."""
    assert replace(SMALL, trajectory=None).fingerprint == "7db90d8acd2cb20c3e818155ff328973"
