"""Settings hold possible values only."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import pytest

from paminsa_viz.explorer.state.loads import LoadsSettings
from paminsa_viz.explorer.state.monte_carlo import MonteCarloSettings
from paminsa_viz.explorer.state.requirements import LargestSettings
from paminsa_viz.explorer.state.settings import Settings, setting, setting_fields
from paminsa_viz.explorer.state.stiffness import StiffnessSettings
from paminsa_viz.explorer.state.synthesis import SynthesisSettings
from paminsa_viz.model import InvalidInput


@pytest.mark.parametrize(
    ("kind", "changes", "allowed"),
    [
        (MonteCarloSettings, {"robots": 10**9}, "1 to 200000"),
        (MonteCarloSettings, {"seed": -1}, "0 to 1e\\+09"),
        (LoadsSettings, {"leg": 3}, "leg 1, leg 2, leg 3; not 3"),
        (StiffnessSettings, {"case": "gale"}, "payload and load, .*; not 'gale'"),
        (LargestSettings, {"seconds": float("nan")}, "1 to 600"),
    ],
)
def test_settings_out_of_their_ranges_and_options_are_refused(
    kind: Any, changes: dict[str, Any], allowed: str
) -> None:
    with pytest.raises(InvalidInput, match=allowed) as refused:
        kind(**changes)
    assert "\n" not in str(refused.value)


@pytest.mark.parametrize("kind", [LoadsSettings, SynthesisSettings])
def test_texts_of_options_have_no_symbols_that_would_need_subscripts(kind: type) -> None:
    texts = [text for one in setting_fields(kind).values() for text in one.options or ()]
    assert texts
    assert not [text for text in texts if "_" in text]


def test_ranges_may_have_one_end() -> None:
    @dataclass(frozen=True)
    class Half(Settings):
        low: float = setting(1.0, "Low", range=(0.0, None))
        high: float = setting(1.0, "High", range=(None, 2.0))

    assert Half(low=1e30, high=-1e30).low == 1e30
    with pytest.raises(InvalidInput, match="Low: at least 0 is possible, not -1"):
        Half(low=-1.0)
    with pytest.raises(InvalidInput, match="High: at most 2 is possible, not 3"):
        Half(high=3.0)
