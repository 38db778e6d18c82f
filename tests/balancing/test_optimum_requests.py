"""Optima that cannot be asked for."""

from __future__ import annotations

import numpy as np
import pytest

from paminsa_viz.balancing import (
    AddedMass,
    Changes,
    CounterweightRange,
    MassRange,
    StaticPeak,
    TrajectoryPeak,
    beyond,
    optimize,
)
from paminsa_viz.model import APPENDIX_4, InvalidDesign, InvalidInput, Misprint, solve_field
from paminsa_viz.trajectory import solve_trajectory
from tests.balancing.robots import field, trajectory, workspace


@pytest.mark.parametrize(
    ("make", "named"),
    [
        (lambda: MassRange("joints.j7", 2.0, 1.0), "joints.j7"),
        (lambda: MassRange("joints.j7", -1.0, 1.0), "joints.j7"),
        (lambda: MassRange("joints.j7", 0.0, np.inf), "joints.j7"),
        (lambda: beyond("b8", 8, -0.1, 1.0), "B8"),
        (lambda: CounterweightRange("b8", 8, 0.0, 0.1, 1.0, 2.0), "B8"),
        (lambda: Changes((MassRange("joints.j7", 0, 1), MassRange("joints.j7", 0, 2))), "j7"),
        (
            lambda: optimize(APPENDIX_4, Changes((MassRange("inertias.b3_axial", 0, 1),)),
                             AddedMass()),
            "inertias.b3_axial",
        ),
        (
            lambda: optimize(APPENDIX_4, Changes((MassRange("counterweights.0.mass", 0, 1),)),
                             AddedMass()),
            "counterweights.0.mass",
        ),
        (lambda: optimize(APPENDIX_4, Changes(), [(-1.0, AddedMass())]), "added mass"),
        (
            lambda: optimize(APPENDIX_4.vary({"geometry.base_radius": 0.36}), Changes(),
                             StaticPeak(field())),
            "field",
        ),
        (
            lambda: optimize(APPENDIX_4, Changes(), TrajectoryPeak(solve_trajectory(
                APPENDIX_4.geometry, trajectory(), misprints=Misprint.APP3_MC4))),
            "trajectory",
        ),
        (
            lambda: optimize(
                APPENDIX_4.vary({"geometry.guide_stroke": 0.05}), Changes(),
                StaticPeak(solve_field(APPENDIX_4.vary(
                    {"geometry.guide_stroke": 0.05}).geometry, workspace())),
            ),
            "field",
        ),
    ],
)  # fmt: skip
def test_impossible_requests_are_refused(make, named: str) -> None:
    with pytest.raises((InvalidInput, InvalidDesign), match=named):
        make()


def test_a_trajectory_that_fails_is_refused() -> None:
    short = APPENDIX_4.vary({"geometry.guide_stroke": 0.1})
    with pytest.raises(InvalidInput, match="whole trajectory"):
        optimize(short, Changes(), TrajectoryPeak(solve_trajectory(short.geometry, trajectory())))
