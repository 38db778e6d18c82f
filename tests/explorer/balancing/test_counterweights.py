"""Counterweights: hung by hand, found by a solver, compared."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from paminsa_viz.explorer.balancing import actions as balancing
from paminsa_viz.explorer.balancing.solving import tidied
from paminsa_viz.explorer.panels.compare_panel import differences_html
from paminsa_viz.explorer.state import State
from paminsa_viz.model import APPENDIX_4, InvalidDesign, static_imbalance
from paminsa_viz.model.parameters import MOST_COUNTERWEIGHTS, Counterweight
from tests.explorer.balancing.balanced import HANGING, solved, with_design


def test_existing_counterweights_may_give_way_to_better_ones(start: State) -> None:
    poor = with_design(start, replace(APPENDIX_4, counterweights=(Counterweight("b4", 5, 0, 2.0),)))
    design = solved(poor).document.design
    assert all(weight.bar != "b4" for weight in design.counterweights)


@given(st.lists(st.sampled_from([0.0, 0.1, 0.2]), max_size=5), st.integers(0, 10**6))
def test_tidying_keeps_the_mechanics(places: list[float], seed: int) -> None:
    masses = np.random.default_rng(seed).choice([0.0, 0.3, 1.1], size=len(places))
    weights = tuple(
        Counterweight("b3", 7, place, float(mass))
        for place, mass in zip(places, masses, strict=True)
    )
    design = replace(APPENDIX_4, counterweights=weights)
    tidy = tidied(design)
    assert static_imbalance(tidy) == pytest.approx(static_imbalance(design), abs=1e-9)
    kept = [(weight.bar, weight.joint, weight.beyond) for weight in tidy.counterweights]
    assert len(kept) == len(set(kept))
    assert all(weight.mass > 0 for weight in tidy.counterweights)


def test_counterweights_are_hung_changed_and_taken_off(start: State) -> None:
    one = balancing.add_counterweight(start, "b8", 8)
    assert one.document.design.counterweights == (HANGING,)
    two = balancing.add_counterweight(one, "b3", 7)
    moved = balancing.change_counterweight(two, 1, 2.5, 0.15)
    assert moved.document.design.counterweights == (HANGING, Counterweight("b3", 7, 0.15, 2.5))
    assert balancing.change_counterweight(moved, 5, 1.0, 0.1) is moved
    with pytest.raises(InvalidDesign):
        balancing.change_counterweight(moved, 0, -1.0, 0.1)
    assert balancing.remove_counterweight(moved, 0).document.design.counterweights == (
        Counterweight("b3", 7, 0.15, 2.5),
    )
    assert balancing.remove_counterweight(moved, -1) is moved
    assert balancing.set_counterweights(moved, ()).document == start.document
    full = balancing.set_counterweights(start, (HANGING,) * MOST_COUNTERWEIGHTS)
    with pytest.raises(InvalidDesign, match="at most"):
        balancing.add_counterweight(full, "b8", 8)


def test_the_comparison_names_counterweights() -> None:
    design = replace(APPENDIX_4, counterweights=(HANGING,))
    text = differences_html(design, APPENDIX_4, "App. 4")
    assert "on B8, 100 mm beyond joint 8" in text
    assert "1 number differs" in text
    assert "No number differs" in differences_html(design, design, "reference")
