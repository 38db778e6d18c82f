"""Counterweights that hit another body are found, and said next to the balance."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from paminsa_viz.clearance import PairGroup, clearance
from paminsa_viz.explorer.features.balance import actions as balancing
from paminsa_viz.explorer.features.balance.solving import run, weight_clearance
from paminsa_viz.explorer.features.balance.texts import details_html
from paminsa_viz.explorer.state.balance import BalanceKind, CounterweightSlot
from paminsa_viz.explorer.state.outcome import solve
from paminsa_viz.explorer.state.state import initial_state
from paminsa_viz.model import APPENDIX_4
from paminsa_viz.model.parameters import Counterweight

POSES = np.array([(0.05 * i, 0.03 * j, 0.2, -0.55) for i in range(-2, 3) for j in range(-2, 3)])


def optimum(lever: float):
    """Balance by a counterweight past joint 8 alone."""
    state = balancing.change_settings(
        initial_state(), slot_b8=CounterweightSlot(lever, 8.0), slot_b3=CounterweightSlot(0.0, 0.0)
    )
    job = balancing.start(state, BalanceKind.OPTIMUM).balance.running
    assert job is not None
    return solve(run, job)


def test_least_distance_is_that_of_the_pairs_with_counterweights() -> None:
    weight = Counterweight("b8", 8, 0.2, 3.0)
    design = replace(APPENDIX_4, counterweights=(weight,))
    found = weight_clearance(design, POSES)
    assert found is not None
    every = clearance(design, POSES, (PairGroup.COUNTERWEIGHTS,)).least
    assert found.distance == pytest.approx(np.nanmin(every), abs=1e-12)
    assert found.touching == np.mean(every[np.isfinite(every)] < 0)
    assert any("ounterweight" in name for name in found.names)
    assert weight_clearance(APPENDIX_4, POSES) is None
    assert (
        weight_clearance(replace(design, counterweights=(replace(weight, mass=0.0),)), POSES)
        is None
    )


@pytest.mark.slow
def test_balance_says_whether_its_counterweights_hit() -> None:
    outcome = optimum(0.3)
    found = outcome.result
    assert found.after.counterweights
    assert found.weights is not None
    text = details_html(outcome)
    assert 'data-testid="weight-clearance"' in text
    assert all(name.lower() in text.lower() for name in found.weights.names)
    assert ("overlap by" in text) == (found.weights.distance < 0)
