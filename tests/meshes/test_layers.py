"""Bars of one leg lie side by side, and nothing drawn passes through anything else."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache
from itertools import combinations

import numpy as np
import pytest

from paminsa_viz.dimensions import layers as at
from paminsa_viz.dimensions.layout import layout
from paminsa_viz.dimensions.placement import BODIES, place_parts
from paminsa_viz.meshes import bodies, frame
from paminsa_viz.meshes.bodies import STANDING, make_body
from paminsa_viz.meshes.part import fixed_part
from paminsa_viz.model.design import APPENDIX_4, KneeBranch
from paminsa_viz.model.kinematics import inverse_kinematics
from tests.meshes.make_parts import script
from tests.meshes.winding import SolidBody
from tests.support.samples import with_knee

pytestmark = pytest.mark.slow


GEOMETRY = APPENDIX_4.geometry

BARS = ("b3", "b4", "b7", "b8")
PARALLEL = ({"b4", "b7"}, {"b3", "b8"})
"""Opposite sides of the parallelogram 8-9-4-7: they never cross."""


def test_bars_that_cross_are_in_layers_of_their_own() -> None:
    for one, other in combinations(BARS, 2):
        (low_a, high_a), (low_b, high_b) = at.span(one), at.span(other)
        same = at.LAYER[one] == at.LAYER[other] and {one, other} in PARALLEL
        assert same or max(low_a - high_b, low_b - high_a) > 0.001, (one, other)


@pytest.mark.parametrize("bar", BARS)
def test_a_bar_keeps_to_its_layer_clear_of_the_middle(bar: str) -> None:
    """Tubes, sockets and barrels; only pins and their collars, which bridge layers, reach out."""
    low, high = at.span(bar)
    assert max(low - at.CORE, -at.CORE - high) > 0.001
    part = make_body(GEOMETRY, f"leg1/{bar}")
    tubes = [solid.mesh.bounds[:, 1] for solid in part.solids if solid.material == "accent"]
    assert tubes
    for tube in tubes:
        assert tube.mean() == pytest.approx(at.LAYER[bar], abs=1e-9)
        assert low < tube[0] < tube[1] < high
    barrel = fixed_part("barrel").bounds()[:, 1]
    assert np.abs(barrel).max() <= at.BARREL / 2 + 0.0005


@pytest.mark.parametrize("body", ["shaft", "guide", "slider"])
def test_bodies_of_the_middle_layer_stay_in_it_but_for_pins(body: str) -> None:
    solids = make_body(GEOMETRY, f"leg1/{body}").solids
    bounds = [s.mesh.bounds for s in solids if s.material in ("body", "accent")]
    # The quill's collar turns above the base plate, out of the bars' reach.
    low = [b for b in bounds if b[1, 2] < at.MOUNT or body != "guide"]
    assert max(np.abs(b[:, 1]).max() for b in low) <= at.CORE + 1e-9


MADE = {make.__name__: cache(make) for make in script.PARTS}


@pytest.fixture
def solid_parts(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """Use the parts as made: in the files, solids of one material are one mesh."""
    for module in (bodies, frame):
        monkeypatch.setattr(module, "fixed_part", lambda name: MADE[name]().copy())
    bodies._made.cache_clear()
    yield
    bodies._made.cache_clear()


def touching() -> set[frozenset[str]]:
    """Return pairs of bodies that a joint holds together: they touch or sit in each other."""
    pairs = [("carriage", "base"), ("carriage", "m4")]
    for leg in (1, 2, 3):
        name = f"leg{leg}/"
        pairs += [(f"m{leg}", name + "guide"), (name + "shaft", "carriage")]
        pairs.append((name + "swivel", "platform"))
        joints = "shaft-guide shaft-b3 guide-slider slider-b7 slider-b8 b8-b4 b4-b3 b3-b7 b4-swivel"
        for joint in joints.split():
            a, b = joint.split("-")
            pairs.append((name + a, name + b))
    pairs += [(a, b) for a in STANDING for b in STANDING]
    return {frozenset(pair) for pair in pairs}


POSES = {
    KneeBranch.LOWER: [
        (0.0, 0.0, 0.0, -0.5), (0.05, -0.03, 0.4, -0.6), (0.0, 0.0, np.pi / 3, -0.5),
        (0.1, 0.1, 0.0, -0.4), (-0.15, 0.1, 0.5, -0.5), "low", "high",
    ],
    KneeBranch.UPPER: [
        (0.0, 0.0, 0.0, 0.45), (0.05, -0.03, 0.4, 0.5), (0.12, 0.06, -0.5, 0.3), "low", "high",
    ],
}  # fmt: skip


@pytest.mark.usefixtures("solid_parts")
@pytest.mark.parametrize("knee", list(KneeBranch))
def test_no_body_passes_through_another(knee: KneeBranch) -> None:
    names = (*STANDING, *BODIES)
    shapes = {name: SolidBody(make_body(with_knee(GEOMETRY, knee), name)) for name in names}
    held = touching()
    free = [p for p in combinations(names, 2) if frozenset(p) not in held]
    place = layout(with_knee(GEOMETRY, knee))
    limits = {"low": place.platform_low, "high": place.platform_high}
    hits = []
    for pose in POSES[knee]:
        where = (0.0, 0.0, 0.0, limits[pose]) if isinstance(pose, str) else pose
        places = place_parts(inverse_kinematics(with_knee(GEOMETRY, knee), where))
        frames = {n: places[n].matrix if n in places else np.eye(4) for n in names}
        world = {n: shapes[n].points @ frames[n][:3, :3].T + frames[n][:3, 3] for n in names}
        bounds = {n: (w.min(axis=0), w.max(axis=0)) for n, w in world.items()}
        for a, b in free:
            (low_a, high_a), (low_b, high_b) = bounds[a], bounds[b]
            if (low_a > high_b).any() or (low_b > high_a).any():
                continue
            for one, other in ((a, b), (b, a)):
                low, high = bounds[other]
                points = world[one]
                points = points[((points > low) & (points < high)).all(axis=1)]
                if not len(points):
                    continue
                frame = frames[other]
                inside = shapes[other].holds((points - frame[:3, 3]) @ frame[:3, :3])
                if inside.any():
                    hits.append((pose, one, other, int(inside.sum())))
    assert hits == []


@pytest.mark.usefixtures("solid_parts")
def test_the_clearance_check_detects_a_collision(monkeypatch: pytest.MonkeyPatch) -> None:
    """B4 in the middle would pass through the shaft with the upper knee."""
    monkeypatch.setitem(at.LAYER, "b4", 0.0)
    configuration = inverse_kinematics(with_knee(GEOMETRY, KneeBranch.UPPER), (0.0, 0.0, 0.0, 0.45))
    places = place_parts(configuration)
    bar, shaft = (SolidBody(make_body(GEOMETRY, f"leg1/{b}")) for b in ("b4", "shaft"))
    into, onto = (places[f"leg1/{b}"].matrix for b in ("b4", "shaft"))
    points = shaft.points @ onto[:3, :3].T + onto[:3, 3]
    assert bar.holds((points - into[:3, 3]) @ into[:3, :3]).any()
