"""The largest value along a curve: where it is looked for, and that it is exact."""

from __future__ import annotations

import numpy as np
import pytest

from paminsa_viz.trajectory.supremum import nodes, supremum


def test_a_largest_value_is_looked_for_at_480_instants_but_24_of_a_piece_at_least() -> None:
    for pieces, each in ((1, 480), (3, 160), (20, 24), (50, 24)):
        breaks = np.linspace(0.0, 1.0, pieces + 1)
        found = nodes(breaks)
        assert len(found) == pieces * each + 2
        assert (np.diff(found) > 0).all()
        inside = np.histogram(found[1:-1], breaks)[0]
        assert (inside == each).all()


@pytest.mark.parametrize(("share", "seen"), [(0.9805, True), (0.9795, False)])
def test_maxima_within_a_fiftieth_of_the_largest_are_followed_up(share: float, seen: bool) -> None:
    """A hill of 1, and a narrow one of 1.2 whose top is between two of the instants."""
    breaks = np.array([0.0, 1.0])
    low, high = nodes(breaks)[100:102]
    middle, width = 0.5 * (low + high), 0.5 * (high - low)

    def hills(u: np.ndarray) -> np.ndarray:
        fall = (1.2 - share) / width
        near = np.maximum(1.2 - fall * np.abs(u - middle), 0.0)
        return np.maximum(1.0 - 4.0 * (u - 0.75) ** 2, near)[:, None]

    assert supremum(hills, breaks).value == pytest.approx(1.2 if seen else 1.0, rel=1e-6)


@pytest.mark.parametrize(("width", "pieces"), [(4.5e-12, 3), (3.5e-12, 2)])
def test_pieces_of_four_rounding_gaps_have_no_instants_of_their_own(
    width: float, pieces: int
) -> None:
    found = nodes(np.array([0.0, 0.25, 0.25 + width, 1.0]))
    assert len(found) == pieces * 160 + 2
    assert (np.diff(found) > 0).all()
    inner = found[(found > 0.2) & (found < 0.3)]
    assert np.abs(inner - 0.25).min() == pytest.approx(1e-12, rel=1e-3)


def test_a_largest_value_is_exact_also_of_steep_hills_and_at_the_ends() -> None:
    """Cosines of any phase and column, infinite ones, and what is nowhere above zero."""
    breaks = np.array([0.0, 0.3, 1.0])
    for top in (0.0, 0.3, 1.0, *np.random.default_rng(0).uniform(0.0, 1.0, 30)):
        for column, size in ((0, 1.0), (2, 1.0), (1, 1e-3)):

            def hill(
                u: np.ndarray, top: float = top, column: int = column, size: float = size
            ) -> np.ndarray:
                found = np.full((len(u), 3), 0.5 * size)
                found[:, column] = size * (2.0 + np.cos(5.0 * (u - top)))
                return found

            best = supremum(hill, breaks)
            assert best.value == pytest.approx(3.0 * size, rel=1e-15)
            assert best.u == pytest.approx(top, abs=1e-7)
            assert best.column == column
    lost = supremum(lambda u: np.where(u > 0.5, np.inf, u)[:, None], breaks)
    assert lost.value == np.inf
    assert 0.5 < lost.u < 0.51
    none = supremum(lambda u: -1.0 - u[:, None], breaks)
    assert (none.value, none.u, none.column) == (-1.0, 0.0, 0)
