"""Whatever a design's ranges allow, every input of every section can be built with it."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
from hypothesis import example, given

from paminsa_viz.explorer.core import actions
from paminsa_viz.explorer.kit.inputs import Number, Pair, Slider
from paminsa_viz.explorer.state.state import initial_state
from paminsa_viz.explorer.tabs import sections
from paminsa_viz.model import APPENDIX_4, Design
from tests.support.entries import flat
from tests.support.samples import edge_designs


class Gui:
    """Refuses what viser refuses: a first value beyond the ends."""

    def add_number(self, label: str, value: float, **given: Any) -> Any:
        self.add_vector2(label, (value,), **given)
        return SimpleNamespace()

    def add_slider(
        self, label: str, low: float, high: float, step: float, value: float, **given: Any
    ) -> Any:
        assert low < high
        return self.add_number(label, value, min=low, max=high)

    def add_vector2(
        self, label: str, value: Any, *, min: Any = None, max: Any = None, **given: Any
    ) -> Any:
        assert np.isfinite(value).all(), label
        assert min is None or (np.array(value) >= min).all(), (label, value, min)
        assert max is None or (np.array(value) <= max).all(), (label, value, max)
        return SimpleNamespace()


@given(design=edge_designs())
@example(design=APPENDIX_4.vary({"geometry.platform_radius": 5e-4}))
def test_every_input_is_built_with_any_allowed_design(design: Design) -> None:
    state = actions.load_design(initial_state(), design)
    inputs = [
        entry
        for section in sections().values()
        for entry in flat(section.entries())
        if isinstance(entry, (Number, Pair, Slider))
    ]
    assert len(inputs) > 100
    for entry in inputs:
        entry.add(Gui(), state, entry.key)
