"""Who does what a refusal says, with the number as it is written there, is not refused again."""

from __future__ import annotations

import math
import re
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from paminsa_viz.cli.accuracy import Accuracy
from paminsa_viz.engines.exported import exported_mjcf
from paminsa_viz.engines.mechanism import build_mechanism
from paminsa_viz.errors import InvalidInput, PaminsaError
from paminsa_viz.explorer.features.motion.simulation import run as simulate
from paminsa_viz.explorer.state.simulation import SimulationJob, SimulationSettings
from paminsa_viz.identification.filtering import filter_log
from paminsa_viz.identification.log import make_log
from paminsa_viz.model import APPENDIX_4, home_pose, inverse_kinematics
from paminsa_viz.progress import go_on
from paminsa_viz.quantities.requirements import Workspace, WorkspaceShape
from paminsa_viz.synthesis import Guide, ObjectiveLimit, Regime, SearchRange, SynthesisCase, refusal
from paminsa_viz.trajectory import Trajectory
from paminsa_viz.trajectory.sampled import sample_times
from tests.support.samples import resized
from tests.synthesis.search_cases import CYLINDER


def case(radius: float, height: float, guide: Guide = Guide.FOLLOWS) -> SynthesisCase:
    workspace = Workspace(WorkspaceShape.CYLINDER, (2 * radius, 2 * radius, height))
    required = replace(CYLINDER.requirements, workspace=workspace)
    return replace(CYLINDER, requirements=required, guide=guide)


def require(case: SynthesisCase) -> None:
    if reason := refusal(case, Regime.SMALLER):
        raise InvalidInput("case", reason)


def longest(case: SynthesisCase, **most: float) -> SynthesisCase:
    """A case whose lengths are searched up to others [m]."""
    ranges = {item.path: item for item in case.ranges}
    ends = {f"geometry.{name}": end for name, end in most.items()}
    return replace(case, ranges=tuple(
        SearchRange(path, one.low, ends.get(path, one.high)) for path, one in ranges.items()
    ))  # fmt: skip


def footprint(millimeters: float) -> None:
    require(replace(case(0.14, 0.4), limits=(ObjectiveLimit("footprint", millimeters / 1e3),)))


def offset(millimeters: float) -> None:
    require(longest(case(0.14, 0.4), base_radius=0.08 + millimeters / 1e3 + 1e-9))


def bars(millimeters: float) -> None:
    require(longest(case(0.14, 0.4), crank_length=0.25, coupler_length=millimeters / 1e3 - 0.25))


def stroke(millimeters: float) -> None:
    geometry = replace(APPENDIX_4.geometry, guide_stroke=millimeters / 1e3)
    kept = case(0.13, 0.4, Guide.KEPT)
    require(replace(kept, reference=replace(APPENDIX_4, geometry=geometry)))


def turn(degrees: float) -> None:
    at = math.radians(degrees)
    turned = longest(case(0.05, 0.4), base_radius=0.2175)
    require(replace(turned, requirements=replace(turned.requirements, bounds=(), theta=(at, at))))


def pantograph(meters: float) -> None:
    lengths = {"geometry.crank_length": 0.1, "geometry.coupler_length": meters - 0.1}
    APPENDIX_4.vary({"geometry.base_radius": 0.4070123} | lengths)


def tilt_inertia(inertia: float) -> None:
    APPENDIX_4.vary({"platform.inertia": 0.0200000123, "elastic.platform_tilt_inertia": inertia})


def axial_inertia(inertia: float) -> None:
    build_mechanism(
        APPENDIX_4.vary({"inertias.b4_transverse": 0.01000003, "inertias.b4_axial": inertia})
    )


def least_mass(kilograms: float) -> None:
    exported_mjcf(
        resized(APPENDIX_4, 0.777).vary({"joints.j2": 0.0, "links.b2": 0.0, "joints.j3": kilograms})
    )


def rate(samples_per_second: float) -> None:
    sample_times(0.0, 1.1997, samples_per_second)


def cut_off(hertz: float, seconds: float = 40.0, sampling: float = 201.23478) -> None:
    t = np.arange(math.floor(seconds * sampling) + 1) / sampling
    pose = np.tile(home_pose(APPENDIX_4.geometry), (t.size, 1))
    q = np.tile(inverse_kinematics(APPENDIX_4.geometry, pose[0]).actuators, (t.size, 1))
    log = make_log(t, q, 0 * q)
    filter_log(
        log, APPENDIX_4.geometry, pose, [slice(0, t.size)], cut_off=hertz, transition_speed=0.01
    )


def piece(seconds: float) -> None:
    cut_off(7.0, seconds)


def payload(kilograms: float) -> None:
    rest = np.zeros((2, 4))
    still = Trajectory(np.array([0.0, 0.01]), rest + home_pose(APPENDIX_4.geometry), rest, rest)
    design = APPENDIX_4.vary({"payload.mass": 1.234567})
    simulate(SimulationJob(design, still, SimulationSettings(payload_mismatch=kilograms)), go_on)


def backlash(degrees: float) -> None:
    Accuracy(backlash=(degrees, 0.0))._design()


@pytest.mark.parametrize(
    ("attempt", "first", "advice"),
    [
        (footprint, 350.0, "it is at least # mm"), (offset, 100.0, "has to be above # mm"),
        (bars, 500.0, "have to be longer than # mm"), (stroke, 10.0, "a stroke of # mm or more"),
        (turn, 80.0, "it is at most #°"), (pantograph, 0.3, "at least # m apart"),
        (tilt_inertia, 0.001, "I_pl/2, # kg"), (axial_inertia, 0.1, "inertia, # kg"),
        (least_mass, 1e-5, "move less than # kg"), (rate, 1e7, "at most # a second"),
        (cut_off, 1e3, "at most # Hz"), (piece, 0.1, "of at least # s is needed"),
        (payload, -5.0, "at least # kg"), (backlash, 180.0, "0 to # degrees"),
    ],
)  # fmt: skip
def test_a_limit_as_it_is_told_is_kept(
    attempt: Callable[[float], None], first: float, advice: str
) -> None:
    with pytest.raises(PaminsaError) as refused:
        attempt(first)
    before, after = map(re.escape, advice.split("#"))
    told = re.search(f"{before}([-+−0-9.e]+){after}", str(refused.value))
    assert told is not None, str(refused.value)
    attempt(float(told[1].replace("−", "-")))
