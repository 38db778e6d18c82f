"""Studies: their designs, what is measured, and tables that do not depend on the workers."""

from __future__ import annotations

import pickle
from dataclasses import replace
from itertools import count

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from paminsa_viz.model import (
    APPENDIX_4,
    InvalidInput,
    KneeBranch,
    check_reach,
    measure_singularity,
    static_torques,
)
from paminsa_viz.model.reach import MARGINS, Limit, home_pose
from paminsa_viz.quantities import QUANTITIES
from paminsa_viz.studies import (
    MOTION_METRICS,
    DesignAxis,
    DesignGrid,
    DesignRange,
    RandomDesigns,
    Region,
    Study,
    default_region,
    measure_design,
    processes,
    run_study,
)
from paminsa_viz.studies.metrics import RUNS, global_indices, measure_motion
from paminsa_viz.studies.region import RegionResults
from paminsa_viz.trajectory import analyze
from tests.studies.studies import GRID, MOTION, MOVED, NAMES, RANDOM, SMALL
from tests.support.samples import random_design, with_knee
from tests.trajectory.crossings import BALANCED, LINE, TEN, shortest

pytestmark = pytest.mark.slow


def test_a_grid_is_every_combination() -> None:
    assert GRID.size == 6
    assert [GRID.values(i) for i in range(6)] == [
        (0.2, 0.1), (0.2, 0.5), (0.2, 0.63), (0.4, 0.1), (0.4, 0.5), (0.4, 0.63),
    ]  # fmt: skip


@given(seed=st.integers(0, 2**32), index=st.integers(0, 10**6))
def test_a_random_design_is_the_same_alone_and_among_more(seed, index) -> None:
    ranges = RANDOM.variation.ranges
    few, many = RandomDesigns(ranges, index + 1, seed), RandomDesigns(ranges, 10**7, seed)
    values = few.values(index)
    assert values == many.values(index)
    assert values != many.values(index + 1)
    assert values != RandomDesigns(ranges, index + 1, seed + 1).values(index)
    assert all(r.low <= v <= r.high for r, v in zip(ranges, values, strict=True))


@pytest.mark.parametrize("knee", list(KneeBranch))
@pytest.mark.parametrize("seed", range(6))
def test_metrics_are_those_of_the_poses(seed, knee) -> None:
    rng = np.random.default_rng(seed)
    design = random_design(rng)
    middle = default_region(with_knee(design, knee))
    region = Region(
        radius=rng.uniform(0.2, 0.8) * design.geometry.base_radius,
        theta=(-0.3, 0.7),
        z=(middle.z[0], 1.1 * middle.z[0]),
        cells=11,
        max_condition=6.0,
    )
    found = dict(
        zip(NAMES, measure_design(with_knee(design, knee), region, base_mass=2.0), strict=True)
    )

    side = region.radius * (np.arange(11) - 5) / 5.5
    x, y, theta, z = np.meshgrid(side, side, region.theta, region.z, indexing="ij")
    pose = np.stack([x, y, theta, z], axis=-1)[np.hypot(x, y) <= region.radius]
    torque = static_torques(with_knee(design, knee), pose)
    reach, near = check_reach(design.geometry, pose), measure_singularity(design.geometry, pose)
    ok = np.isfinite(torque).all(axis=-1)
    margins = reach.margins.reshape(len(pose), -1)
    at_guide = margins.argmin(axis=-1) % len(MARGINS) == MARGINS.index(Limit.GUIDE)
    least = 0.01 * (design.geometry.crank_length + design.geometry.coupler_length) / 1.05
    usable = ok & (near.condition <= 6.0) & ((margins.min(axis=-1) >= least) | at_guide)
    assert found["reached_share"] == pytest.approx(ok.mean())
    assert found["usable_share"] == pytest.approx(usable.mean())
    assert found["mass_kg"] - found["added_mass_kg"] == pytest.approx(2.0)
    assert found["reach_margin_m"] == pytest.approx(reach.margins.min())
    circle = near.position_distance + np.hypot(pose[:, 0], pose[:, 1])
    assert found["singular_distance_m"] == pytest.approx(circle.min() - region.radius)
    ratio = design.geometry.platform_radius / design.geometry.base_radius
    turn = np.arccos(ratio) - 0.7 if ratio <= 1 else np.nan
    assert found["singular_turn_rad"] == pytest.approx(turn, nan_ok=True)
    if ok.any():
        assert found["worst_condition"] == pytest.approx(near.condition[ok].max())
        assert found["median_condition"] == pytest.approx(np.median(near.condition[ok]))
    if usable.any():
        rotary = torque[usable, :3]
        assert found["peak_torque_Nm"] == pytest.approx(np.abs(rotary).max())
        assert found["rms_torque_Nm"] == pytest.approx(np.sqrt((rotary**2).mean()))
        assert found["peak_force_N"] == pytest.approx(np.abs(torque[usable, 3]).max())


def test_an_angle_and_a_turn_more_are_the_same_heading() -> None:
    region = Region(radius=0.1, theta=(-0.5, 0.2), z=(-0.5,), cells=4)
    turned = replace(region, theta=(2 * np.pi - 0.5, 0.2 - 4 * np.pi))
    same = measure_design(APPENDIX_4, region)
    assert measure_design(APPENDIX_4, turned) == pytest.approx(same, rel=1e-9)


@pytest.mark.parametrize("variation", [MOVED.variation, GRID], ids=["random", "grid"])
def test_motion_cells_are_those_of_the_analysis(variation) -> None:
    study = replace(MOVED, variation=variation)
    found = set()
    for index in range(study.size):
        row = dict(zip(study.columns, study.row(index), strict=True))
        analysis = analyze(study.vary(variation.values(index)), MOTION)
        cells = [row[metric.column] for metric in MOTION_METRICS]
        event = analysis.check.first
        found.add(event is None)
        if event is not None:
            assert row["motion"].partition(":")[0] == event.limit.word
            assert row["motion"].endswith(f":leg{event.leg + 1}") == (event.leg >= 0)
            assert (row["motion_fails_s"], set(cells)) == (repr(event.t), {""})
            continue
        summary = analysis.summary
        expected = [
            np.abs(analysis.torque[:, :3]).max(),
            np.sqrt(np.mean([motor.rms**2 for motor in summary[:3]])),
            np.abs(analysis.torque[:, 3]).max(),
            sum(motor.driven for motor in summary),
        ]
        assert (row["motion"], row["motion_fails_s"]) == ("ok", "")
        assert list(map(float, cells)) == pytest.approx(expected, rel=1e-12)
    assert found == {True, False}


def test_a_row_says_why_there_are_no_numbers(tmp_path) -> None:
    study = replace(SMALL, region=replace(SMALL.region, z=(5.0,)))
    cells = dict(zip(study.columns, study.row(0), strict=True))
    assert (cells["status"], cells["reached_share"]) == ("not-reached", "0.0")
    assert cells["peak_torque_Nm"] == cells["worst_condition"] == ""
    assert replace(study, indices=("transmission",)).row(0)[-3:] == ("", "", "")
    near = replace(SMALL, region=replace(SMALL.region, max_condition=1.0))
    cells = dict(zip(near.columns, near.row(4), strict=True))
    assert (cells["status"], cells["usable_share"]) == ("not-usable", "0.0")
    assert float(cells["reached_share"]) > 0
    assert cells["peak_torque_Nm"] == cells["rms_torque_Nm"] == ""
    axis = DesignAxis("geometry.magnification", (0.5, 3.0))
    study = replace(MOVED, variation=DesignGrid((axis,)))
    assert study.row(0)[:3] == ("0", "0.5", "impossible:geometry.magnification")
    assert set(study.row(0)[3:]) == {""}
    summary = run_study(study, tmp_path / "a.csv")
    assert (summary.status, sum(summary.motion.values())) == ({"impossible": 1, "ok": 1}, 1)
    assert not [name for name in SMALL.columns if "motion" in name]


def test_bars_follow_their_lengths_and_masses_that_vary_do_not() -> None:
    lengths = DesignGrid((DesignAxis("geometry.crank_length", (0.84,)),))
    scaled = replace(SMALL, variation=lengths, scale_bars=True)
    assert scaled.vary((0.84,)).links.b8 == pytest.approx(2 * APPENDIX_4.links.b8)
    both = DesignGrid((DesignAxis("links.b8", (0.1,)), *lengths.axes))
    assert replace(scaled, variation=both).vary((0.1, 0.84)).links.b8 == 0.1
    assert replace(SMALL, variation=lengths).vary((0.84,)).links == APPENDIX_4.links


@pytest.mark.parametrize(
    ("make", "place"),
    [
        (lambda: DesignAxis("links.b33", (1.0,)), "did you mean links.b3"),
        (lambda: DesignAxis("links.b3", ()), "links.b3"),
        (lambda: DesignAxis("links.b3", (1.0, np.nan)), "links.b3"),
        (lambda: DesignRange("links.b3", 1.0, 1.0), "links.b3"),
        (lambda: DesignRange("links.b3", 1.0, np.inf), "links.b3"),
        (lambda: DesignRange("links.b3", "1", 2.0), "links.b3"),
        (lambda: DesignRange.around(APPENDIX_4, "payload.mass", 0.1), "payload.mass: is 0"),
        (lambda: DesignGrid(()), "at least one"),
        (lambda: DesignGrid(GRID.axes * 2), "varies twice"),
        (lambda: RandomDesigns(RANDOM.variation.ranges, 0), "size"),
        (lambda: RandomDesigns(RANDOM.variation.ranges, 1, -1), "seed"),
        (lambda: Region(0.0, (0.0,), (0.0,)), "radius"),
        (lambda: Region(0.1, (), (0.0,)), "theta"),
        (lambda: Region(0.1, (0.0,), (np.inf,)), "z"),
        (lambda: Region(0.1, (0.0, np.nan), (0.0,)), "theta"),
        (lambda: Region(0.1, (0.0,), (0.0,), cells=1), "2 to 1000 cells are possible, not 1"),
        (lambda: Region(0.1, (0.0,), (0.0,), cells=1001), "2 to 1000 cells are possible"),
        (lambda: Region(0.1, (0.0,), (0.0,), max_condition=0.5), "max_condition"),
        (lambda: processes(0).__enter__(), "workers"),
    ],
    ids=count(),
)
def test_impossible_requests_are_rejected(make, place) -> None:
    with pytest.raises(InvalidInput, match=place):
        make()


def test_what_is_just_possible_is_taken() -> None:
    assert Region(0.1, (0.0,), (0.0,), cells=2, max_condition=1.0).grid().size == 4
    assert Region(0.1, (0.0,), (0.0,), cells=1000).cells == 1000
    ranges = RANDOM.variation.ranges
    assert RandomDesigns(ranges, 1, 0).size == 1
    low = APPENDIX_4.geometry.base_radius
    assert (ranges[1].low, ranges[1].high) == pytest.approx((0.5 * low, 1.5 * low))


def test_global_indices_are_mean_least_and_spread_over_the_region() -> None:
    keys = ("horizontal_force", "transmission")
    study = replace(SMALL, indices=keys)
    rows = [dict(zip(study.columns, study.row(i), strict=True)) for i in range(study.size)]
    number = next(i for i, row in enumerate(rows) if row["status"] == "ok")
    row = rows[number]
    found = RegionResults(study.vary(study.variation.values(number)), study.region)
    for key in keys:
        values = QUANTITIES[key].over(found.field, found.design)[found.reached]
        unit = {"horizontal_force": "_N"}.get(key, "")
        assert float(row[f"mean_{key}{unit}"]) == pytest.approx(values.mean())
        assert float(row[f"min_{key}{unit}"]) == pytest.approx(values.min())
        assert float(row[f"spread_{key}{unit}"]) == pytest.approx(values.std())
    assert study.columns[: len(SMALL.columns)] == SMALL.columns
    assert study.fingerprint != SMALL.fingerprint
    pickle.loads(pickle.dumps(study)).row(0)


def test_what_is_the_same_everywhere_has_no_spread() -> None:
    found = RegionResults(APPENDIX_4, default_region(APPENDIX_4))
    values = found.values(QUANTITIES["selective_z"])
    assert np.ptp(values) == 0
    mean, least, spread = (metric.value(found) for metric in global_indices(["selective_z"]))
    assert mean == pytest.approx(1 / APPENDIX_4.geometry.magnification)
    assert least == values[0]
    assert spread == 0


def test_a_load_that_varies_is_one_more_axis() -> None:
    axis = DesignAxis("load.force_x", (-50.0, 0.0, 50.0))
    study = Study(APPENDIX_4, DesignGrid((axis,)), SMALL.region)
    rows = [dict(zip(study.columns, study.row(index), strict=True)) for index in range(3)]
    peaks = [float(row["peak_torque_Nm"]) for row in rows]
    assert peaks[1] < min(peaks[0], peaks[2])


def test_the_default_region_is_at_the_home_pose() -> None:
    for knee in KneeBranch:
        design = APPENDIX_4.with_knee(knee)
        assert default_region(design).z == (home_pose(design.geometry)[3],)


def test_a_sweep_takes_a_planned_crossing_for_its_own_design_alone() -> None:
    samples = shortest(BALANCED, LINE, TEN).plan.sample(1000.0)
    word, _, values = measure_motion(BALANCED, samples)
    assert word == RUNS
    assert values[0] == pytest.approx(10.0, rel=1e-2)
    word, t, values = measure_motion(APPENDIX_4, samples)
    assert word == "singular"
    assert t == samples.passages[0].t
    assert np.isnan(values).all()
