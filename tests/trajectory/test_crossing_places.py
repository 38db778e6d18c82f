"""Where paths meet the loci of type-2 singularities: crossings, touches, ends."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from paminsa_viz.model import APPENDIX_4, singular_radius, singular_rotation
from paminsa_viz.trajectory.crossing import (
    NODES,
    Crossing,
    CrossingKind,
    Locus,
    PathOnLocus,
    crossings,
    locus_distances,
)
from paminsa_viz.trajectory.paths import straight_path
from tests.support.samples import enlarged

GEOMETRY = APPENDIX_4.geometry
RADIUS = float(singular_radius(GEOMETRY, 0.3))


@pytest.mark.parametrize("radius", [0.1, 0.35, 0.5], ids=["small", "equal", "large"])
def test_distances_of_the_loci_are_lengths_next_to_them_and_change_their_signs(
    radius: float,
) -> None:
    """To first order, so that they are smooth across; a platform as large as the base turns on."""
    g = replace(APPENDIX_4.geometry, platform_radius=radius)
    rng = np.random.default_rng(4)
    theta = rng.uniform(0.3, 1.0, 50) * rng.choice([-1.0, 1.0], 50)
    angle, off = rng.uniform(0.0, 2 * np.pi, 50), rng.choice([-1e-5, 1e-5], 50)
    far = singular_radius(g, theta) - off
    poses = np.stack([far * np.cos(angle), far * np.sin(angle), theta, 0 * theta - 0.5], axis=1)
    circle, other = locus_distances(g, poses).T
    np.testing.assert_allclose(circle, off, rtol=1e-3)
    if radius >= g.base_radius:
        np.testing.assert_array_equal(other, g.base_radius + radius)
        return
    turn = singular_rotation(g)
    poses[:, 2] = np.sign(theta) * (turn - off / radius)
    np.testing.assert_allclose(locus_distances(g, poses)[:, 1], off, rtol=1e-3)


def test_a_path_along_a_locus_is_refused() -> None:
    turn = singular_rotation(APPENDIX_4.geometry)
    path = straight_path([0.0, 0.0, turn, -0.5], [0.1, 0.0, turn, -0.5])
    with pytest.raises(PathOnLocus):
        crossings(APPENDIX_4.geometry, path)

    def late(s: Any, order: int = 0) -> Any:
        """Comes to the locus after 0.3 of the way, and stays."""
        found = np.zeros((len(s), 4))
        found[:, 0], found[:, 2], found[:, 3] = 0.1 * s, turn - np.maximum(0.3 - s, 0.0), -0.5
        return found

    with pytest.raises(PathOnLocus, match=r"from s = 0\.3 on .* singular rotation") as refused:
        crossings(APPENDIX_4.geometry, late)
    assert (refused.value.s, refused.value.locus) == (pytest.approx(0.3), Locus.ROTATION)


@pytest.mark.parametrize("share", [0.1234, 0.5, 0.9771])
def test_a_path_touches_the_circle_or_crosses_it_twice_or_misses_it(share: float) -> None:
    """Lines beside the tangent of the singular circle, which they touch anywhere on the way."""
    geometry = APPENDIX_4.geometry
    radius, length = float(singular_radius(geometry, 0.3)), 0.2
    start, end = -share * length, (1.0 - share) * length

    def found(beside: float) -> tuple[Crossing, ...]:
        x = radius + beside
        return crossings(geometry, straight_path([x, start, 0.3, -0.5], [x, end, 0.3, -0.5]))

    (touched,) = found(0.0)
    assert touched.kind is CrossingKind.TANGENT
    assert touched.locus is Locus.CIRCLE
    assert touched.s == pytest.approx(share, abs=1.2e-4)  # 1e-9 m off the circle counts as on it
    assert touched.pose == pytest.approx((radius, 0.0, 0.3, -0.5), abs=2.4e-5)
    assert found(1e-6) == ()
    half = np.sqrt(2e-5 * radius) / length
    both = found(-1e-5)
    assert [item.kind for item in both] == [CrossingKind.SIMPLE] * 2
    assert [item.s for item in both] == pytest.approx([share - half, share + half], rel=1e-4)


@pytest.mark.parametrize("share", [0.0, 1.0 / 4000, 0.25, 1.0 / 3.0, 1.0 - 1.0 / 4000, 1.0])
def test_a_path_across_the_circle_is_simple_at_its_ends_and_at_nodes_too(share: float) -> None:
    geometry = APPENDIX_4.geometry
    radius, length = float(singular_radius(geometry, 0.3)), 0.2
    ends = [[radius + (at - share) * length, 0.0, 0.3, -0.5] for at in (0.0, 1.0)]
    for beside in (0.0, 3e-10, -3e-10):  # within what counts as on it
        shift = np.array([beside, 0.0, 0.0, 0.0])
        (found,) = crossings(geometry, straight_path(*(np.array(ends) + shift)))
        assert (found.kind, found.locus) == (CrossingKind.SIMPLE, Locus.CIRCLE)
        assert found.s == pytest.approx(share, abs=1e-8)
    for aside in (-0.05 - share, 1.05 - share):  # that it would only come to before or after
        shift = np.array([aside * length, 0.0, 0.0, 0.0])
        assert crossings(geometry, straight_path(*(np.array(ends) - shift))) == ()


@pytest.mark.parametrize(
    ("slope", "bend", "kind"),
    [
        (0.0, 0.5, CrossingKind.TANGENT), (0.0, 0.67, CrossingKind.TANGENT),
        (0.0, 0.9, CrossingKind.TANGENT), (0.95, 1.0, CrossingKind.TANGENT),
        (1.05, 1.0, CrossingKind.SIMPLE), (1.05, 0.3, CrossingKind.SIMPLE),
    ],
)  # fmt: skip
def test_an_end_is_tangent_by_its_slope_whatever_the_bend(
    slope: float, bend: float, kind: CrossingKind
) -> None:
    """Paths that leave the singular circle radially; slopes in millionths of R_b."""
    radius = float(singular_radius(APPENDIX_4.geometry, 0.0))
    first = slope * 1e-6 * APPENDIX_4.geometry.base_radius

    def path(s: Any, order: int = 0) -> Any:
        away = (first * s + 0.5 * bend * s**2, first + bend * s)[order]
        found = np.zeros((len(s), 4))
        found[:, 0] = (0.0 if order else radius) - away
        found[:, 3] = 0.0 if order else -0.5
        return found

    found, *_ = crossings(APPENDIX_4.geometry, path)
    assert (found.s, found.kind) == (0.0, kind)


def touching(share: float, length: float, beside: float, size: float = 1.0) -> tuple[Crossing, ...]:
    """What a line meets beside the tangent of the circle that it touches at a share of the way.

    Lengths are of a robot so many times as large.
    """
    scale = np.array([size, size, 1.0, size])
    ends = [[RADIUS + beside, (at - share) * length, 0.3, -0.5] * scale for at in (0.0, 1.0)]
    return crossings(enlarged(APPENDIX_4, size).geometry, straight_path(*ends))


@pytest.mark.parametrize("share", [0.500125, 0.1234, 0.5, 1.3 / 4000, 1.0 - 1.3 / 4000])
def test_long_lines_touch_the_circle_between_places_looked_at_and_at_them(share: float) -> None:
    for length in (1.0, 2.0):
        (touched,) = touching(share, length, 0.0)
        assert touched.kind is CrossingKind.TANGENT
        assert touched.s == pytest.approx(share, abs=1e-7)
        assert touched.pose == pytest.approx((RADIUS, 0.0, 0.3, -0.5), abs=1e-6)
    for length, size in ((1.0, 1.0), (2.0, 1.0), (1.0, 0.01), (1.0, 10.0)):
        # a nanometer counts as on it, at Appendix 4's size
        assert len(touching(share, length, 0.97e-9, size)) == 1
        assert touching(share, length, 1.03e-9, size) == ()


@pytest.mark.parametrize("half", [0.4, 0.8, 0.95])
@pytest.mark.parametrize("share", [0.5, 0.5 + 0.02 / 4000])
def test_two_crossings_with_one_place_looked_at_between_are_no_third(
    share: float, half: float
) -> None:
    """Half of the chord, in steps between the places that are looked at."""
    chord = half / 4000
    both = touching(share, 2.0, -((2.0 * chord) ** 2) / (2.0 * RADIUS))
    assert [item.kind for item in both] == [CrossingKind.SIMPLE] * 2
    assert [item.s for item in both] == pytest.approx([share - chord, share + chord], abs=1e-6)


@pytest.mark.parametrize("corner", [False, True])
def test_a_touch_as_far_from_two_places_looked_at_is_seen(corner: bool) -> None:
    """A path that is exactly alike on both sides of its middle; with a corner, where it touches."""

    def path(s: Any, order: int = 0) -> Any:
        beside = (NODES - 1) * np.asarray(s) - 2000.5  # exact at the places looked at
        found = np.zeros((*np.shape(s), 4))
        if corner:  # with a slope that a crossing might have
            found[..., 0] = 2.0**-19 * (np.sign(beside) * (NODES - 1) if order else np.abs(beside))
        else:
            found[..., 1] = 2.0**-12 * ((NODES - 1) if order else beside)
        return found + (0.0 if order else np.array([RADIUS, 0.0, 0.3, -0.5]))

    distance = locus_distances(GEOMETRY, path(np.linspace(0.0, 1.0, NODES)))[:, 0]
    assert distance[2000] == distance[2001]
    (touched,) = crossings(GEOMETRY, path)
    assert touched.kind is CrossingKind.TANGENT
    assert touched.s == pytest.approx(2000.5 / (NODES - 1), abs=1e-7)


@pytest.mark.parametrize(
    ("apart", "kind"), [(0.95, CrossingKind.DOUBLE), (1.05, CrossingKind.SIMPLE)]
)
def test_crossings_of_both_loci_are_double_within_a_millionth_of_the_path(
    apart: float, kind: CrossingKind
) -> None:
    """A path through both of them, moved aside by what puts them so far apart."""
    turn = float(singular_rotation(GEOMETRY))
    meet = np.array([float(singular_radius(GEOMETRY, turn)), 0.0, turn, -0.5])
    shift = np.array([0.05, 0.0, 0.1, 0.0])
    ahead, behind = locus_distances(GEOMETRY, meet + np.array([[1e-6], [-1e-6]]) * shift)[:, 0]
    rate = (ahead - behind) / 2e-6 * 2.0  # the path is two shifts long
    aside = np.array([1.0, 0.0, 0.0, 0.0]) * apart * 1e-6 * rate
    both = crossings(GEOMETRY, straight_path(meet - shift + aside, meet + shift + aside))
    assert [item.kind for item in both] == [kind] * 2
    assert {item.locus for item in both} == set(Locus)
    assert both[1].s - both[0].s == pytest.approx(apart * 1e-6, rel=1e-3)


def test_where_base_and_platform_are_alike_the_circle_may_be_a_point() -> None:
    equal = replace(GEOMETRY, platform_radius=GEOMETRY.base_radius)
    circle, turn = locus_distances(
        equal, np.array([[0.1, 0.0, 0.0, -0.5], [0.0, 0.0, 0.0, -0.5]])
    ).T
    assert circle[0] < -0.1
    assert circle[1] == 0.0
    assert turn.tolist() == [0.7, 0.7]
