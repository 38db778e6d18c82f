"""The tab Stiffness in a browser: results as a tube is changed, a mode that moves by itself."""

from __future__ import annotations

import pytest

from paminsa_viz.explorer.scene.elasticity import MODE_NODE
from tests.support.chromium import Tab, until

pytestmark = pytest.mark.browser

WEIGHT = """name => {
  let weight = null;
  window.__viserMutable.nodeRefFromName[name]?.traverse(node => {
    weight = node.morphTargetInfluences?.[0] ?? weight;
  });
  return weight;
}"""


def test_a_mode_is_animated_and_a_diameter_changes_its_frequency(tab: Tab) -> None:
    tab.open_tab("Stiffness")
    until(lambda: bool(tab.state.elastic_view.result), "a result")
    before = tab.state.elastic_view.result
    assert before is not None
    result = tab.page.get_by_test_id("stiffness-result")
    result.get_by_text(f"{before.frequencies[0]:.3g}").first.wait_for()

    tab.page.get_by_label("Animate mode").check(force=True)
    seen: set[float] = set()

    def moves() -> bool:
        weight = tab.page.evaluate(WEIGHT, MODE_NODE)
        if weight is not None:
            seen.add(round(weight, 2))
        return len(seen) > 4

    until(moves, "the mode swings")
    assert all(-1 <= weight <= 1 for weight in seen)
    field = tab.number_box("B4 outer ⌀ [mm]")
    field.fill("60")
    field.press("Tab")
    until(
        lambda: tab.state.elastic_view.result.frequencies[0] > 1.02 * before.frequencies[0],  # type: ignore[union-attr]
        "a stiffer robot",
    )
    after = tab.state.elastic_view.outcome
    assert after is not None
    assert after.job.design.elastic.b4_outer == 0.06
