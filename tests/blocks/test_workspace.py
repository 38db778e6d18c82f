"""Sizes of a robot in closed form, shares of poses, and statistics of torques, from scratch."""

from __future__ import annotations

from collections import Counter
from typing import Any

import numpy as np
import pytest

from paminsa_viz.blocks import workspace
from paminsa_viz.blocks.evaluation import evaluation_text
from paminsa_viz.errors import InvalidInput
from paminsa_viz.model import APPENDIX_4, Limit, check_reach, singular_radius, static_torques
from paminsa_viz.model.reach import workspace_height, workspace_radius
from tests.blocks.said import cells, said
from tests.support.samples import random_poses

G = APPENDIX_4.geometry


def test_sizes_follow_from_the_lengths() -> None:
    values = [value for _, value in cells(workspace._sizes(G, 0.3))]
    shown = [f"{1e3 * size:.4g} mm" for size in (
        workspace_radius(G), workspace_height(G), 1.05, 1.5 * 0.25, 0.3635)]  # fmt: skip
    assert values[:5] == shown
    assert values[5] == "± 73.4°"
    assert values[6] == f"{1e3 * float(singular_radius(G, 0.3)):.4g} mm"
    wider = APPENDIX_4.vary({"geometry.platform_radius": 0.4}).geometry
    assert cells(workspace._sizes(wider, 0.3))[5][1] == "none"


def test_shares_are_of_the_middles_of_the_cells_of_a_box(monkeypatch: pytest.MonkeyPatch) -> None:
    counts = (7, 6, 3, 5)
    monkeypatch.setattr(workspace, "CELLS", counts)
    table = workspace._shares(APPENDIX_4)
    turn = np.arccos(0.1 / 0.35)
    halves = (workspace_radius(G), workspace_radius(G), turn, workspace_height(G))
    axes = [
        np.linspace(-half, half, 2 * n + 1)[1::2] for half, n in zip(halves, counts, strict=True)
    ]
    x, y, theta, z = np.meshgrid(*axes, indexing="ij")
    status = check_reach(G, np.stack([x, y, theta, z - G.platform_joint_height], axis=-1)).status
    expected = []
    for limit in Limit:
        if count := int((status == limit).sum()):
            text = limit.explanation
            words = text[0].upper() + text[1:]
            expected.append((words, f"{100 * count / status.size:.1f} %"))
    assert cells(table) == expected
    assert [row.kind for row in table.rows] == ["total"] + ["plain"] * (len(expected) - 1)
    assert f"on a grid of {status.size} poses" in table.caption
    assert "|θ| ≤ 73.4°" in table.caption


def test_the_middle_is_among_the_poses_that_are_counted_and_their_number_is_round() -> None:
    assert all(count % 2 for count in workspace.CELLS)
    assert workspace.SAMPLED % 1000 == 0


def test_torques_of_random_poses_by_their_shares(monkeypatch: pytest.MonkeyPatch) -> None:
    poses = random_poses(np.random.default_rng(0), APPENDIX_4, 400)
    seeds: list[int] = []
    monkeypatch.setattr(
        workspace, "workspace_poses", lambda g, count, seed: seeds.append(seed) or poses
    )
    (table,) = workspace._torques(APPENDIX_4, 7)
    assert workspace.workspace_blocks(APPENDIX_4, 0.1)
    assert seeds == [7, 0]
    size = np.abs(static_torques(APPENDIX_4, poses))
    for j, row in enumerate(cells(table)):
        column = np.sort(size[:, j])
        numbers = [np.sqrt(np.mean(column**2)), *np.quantile(column, [0.5, 0.95, 0.99])]
        unit = "N" if j == 3 else "N·m"
        assert [cell.partition(" ")[2] for cell in row[1:]] == [unit] * 4
        for cell, number in zip(row[1:], numbers, strict=True):
            assert float(cell.partition(" ")[0]) == pytest.approx(number, rel=5e-4)

    def refused(*given: Any) -> None:
        raise InvalidInput("poses", "none is found")

    monkeypatch.setattr(workspace, "workspace_poses", refused)
    assert said(workspace._torques(APPENDIX_4, 0)) == [
        ("Static torques over the workspace: none is found.", "warn")
    ]


def test_rows_of_a_table_with_numbers_and_without() -> None:
    assert evaluation_text(Counter({"ok": 1})) == "1 row"
    counts = Counter({"ok": 5, "guide-end:leg1": 1, "stretched:leg2": 3})
    text = "9 rows, 4 without numbers (3 stretched:leg2, 1 guide-end:leg1)"
    assert evaluation_text(counts) == text
    assert evaluation_text(Counter({"a": 2})) == "2 rows, 2 without numbers (2 a)"
