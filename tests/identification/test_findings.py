"""Everything that logs of a robot say, put together: each part is that of its own function."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from paminsa_viz.identification import (
    IdentificationSettings,
    InvalidLog,
    find_causes,
    identify,
    make_log,
    nearest_masses,
    validate,
    weigh_payload,
)
from paminsa_viz.identification.findings import STEPS, investigate
from paminsa_viz.model import APPENDIX_4, Payload, backend
from paminsa_viz.progress import Canceled
from tests.support.identification_logs import multi_sine, simulated

QUICK = IdentificationSettings(robustness=False)
LOG = simulated(1, APPENDIX_4, rate=200.0)
OTHER = simulated(2, APPENDIX_4, rate=200.0)
LOADED = simulated(2, replace(APPENDIX_4, payload=Payload(2.0, 0.01)), rate=200.0)


@pytest.mark.slow
def test_each_part_is_that_of_its_own_function_and_is_there_if_its_log_is() -> None:
    backend.compile_now()  # or kernels could take over in between, with other rounding
    shares: list[tuple[str, float]] = []
    found = investigate(
        LOG, APPENDIX_4, QUICK, other=OTHER, loaded=LOADED, payload=2.0,
        progress=lambda share, step: bool(shares.append((step, share))),
    )  # fmt: skip
    assert dict(shares) == pytest.approx(dict(zip(STEPS, (0.0, 0.2, 0.4, 0.6, 0.8), strict=True)))
    own = identify(APPENDIX_4, LOG, QUICK)
    assert found.identification.estimates == own.estimates
    assert found.nearest.masses == nearest_masses(own).masses
    assert found.causes.ranked == find_causes(own).ranked
    assert found.validation is not None
    np.testing.assert_array_equal(found.validation.residual, validate(own, OTHER).residual)
    assert found.payload == weigh_payload(own, LOADED, known=2.0)
    alone = investigate(LOG, APPENDIX_4, QUICK)
    assert (alone.validation, alone.payload) == (None, None)


@pytest.mark.parametrize("step", [1, 3])
def test_the_work_can_be_canceled_before_each_step(step: int) -> None:
    seen: list[Any] = []

    def stop(share: float, **_: str) -> bool:
        seen.append(share)
        return len(seen) == step

    with pytest.raises(Canceled):
        investigate(LOG, APPENDIX_4, QUICK, progress=stop)
    assert len(seen) == step


def test_the_motion_is_that_of_the_first_piece() -> None:
    kept = np.r_[0:2500, 2600 : len(LOG.t)]
    log = make_log(LOG.t[kept], LOG.position[kept], LOG.torque[kept], split=True, name="cut")
    found = investigate(log, APPENDIX_4, QUICK)
    motion, signals = found.motion, found.identification.signals
    assert (motion.name, motion.t[0]) == ("cut", 0.0)
    assert motion.size == np.count_nonzero(signals.t < 12.5)
    pose, velocity, acceleration = multi_sine(1)(signals.t[: motion.size])
    np.testing.assert_allclose(motion.t, signals.t[: motion.size] - signals.t[0])
    for mine, true in ((motion.pose, pose), (motion.velocity, velocity)):
        np.testing.assert_allclose(mine, true, atol=0.05 * np.abs(true).max())
    assert np.corrcoef(motion.acceleration[:, 2], acceleration[:, 2])[0, 1] > 0.99


def test_a_log_is_no_second_log_of_itself() -> None:
    with pytest.raises(InvalidLog, match="has the positions of the first log"):
        investigate(LOG, APPENDIX_4, QUICK, other=replace(LOG, name="again"))
