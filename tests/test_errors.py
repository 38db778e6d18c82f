"""Errors of the package go from one process to another as they are."""

from __future__ import annotations

import pickle
from collections.abc import Callable
from copy import deepcopy
from typing import Any

import numpy as np
import pytest

from paminsa_viz.errors import PaminsaError
from paminsa_viz.files import load_design, read_log
from paminsa_viz.identification import make_log
from paminsa_viz.model import APPENDIX_4, require_reachable, static_torques
from paminsa_viz.trajectory import (
    MotionLimits,
    check_path,
    line,
    shortest_motion,
    straight_path,
    time_optimal,
)

POSE = np.array([0.0, 0.0, 0.0, -0.55])
WEAK = MotionLimits(torque=1e-3)

REFUSED: dict[str, Callable[[], Any]] = {
    "InvalidInput": lambda: static_torques(APPENDIX_4, [1.0]),
    "InvalidDesign": lambda: APPENDIX_4.vary({"links.b4": -1.0}),
    "UnreachablePose": lambda: require_reachable(APPENDIX_4, POSE * 20),
    "DesignFileError": lambda: load_design("missing.toml"),
    "TableFileError": lambda: read_log("missing.csv"),
    "InvalidLog": lambda: make_log(np.full(12, np.nan), np.zeros((12, 4)), np.zeros((12, 4))),
    "ImpossibleTrajectory": lambda: check_path(
        APPENDIX_4, line(POSE, [2.0, 0.0, -0.55]).sample(50.0)
    ).require(),
    "CrossingRefused": lambda: time_optimal(APPENDIX_4, straight_path(POSE, POSE + 0.02), WEAK),
    "InfeasibleMotion": lambda: shortest_motion(line(POSE, POSE[:3] + 0.02), WEAK, APPENDIX_4),
}


@pytest.mark.parametrize("kind", REFUSED)
def test_an_error_of_a_worker_arrives_with_its_text_and_data(kind: str) -> None:
    """A pool of processes whose worker's error cannot be unpickled never returns."""
    with pytest.raises(PaminsaError) as caught:
        REFUSED[kind]()
    error = caught.value
    assert type(error).__name__ == kind
    for found in (pickle.loads(pickle.dumps(error)), deepcopy(error)):
        assert type(found) is type(error)
        assert str(found) == str(error)
        assert vars(found).keys() == vars(error).keys()
