"""Conflicts, causes, surfaces and checks of volumes, part by part with made-up ones."""

from __future__ import annotations

import io
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import fast_simplification
import numpy as np
import pytest
import trimesh

from paminsa_viz import palette
from paminsa_viz.model import (
    APPENDIX_4,
    check_reach,
    measure_singularity,
    static_torques,
)
from paminsa_viz.model.reach import MARGINS, Limit
from paminsa_viz.quantities.requirements import Requirement, Requirements, Workspace, WorkspaceShape
from paminsa_viz.synthesis.volume import check, conflict, workspace
from paminsa_viz.synthesis.volume.causes import (
    FIRST_REACH,
    INSIDE,
    SINGULAR,
    CauseKind,
    bound_size,
    causes_of,
    counts,
)
from paminsa_viz.synthesis.volume.check import Over, RequirementsCheck
from paminsa_viz.synthesis.volume.conflict import _conflict_of, _moved, _relaxation
from paminsa_viz.synthesis.volume.grid import COARSE, FINE
from paminsa_viz.synthesis.volume.margins import Columns
from paminsa_viz.synthesis.volume.reach import reach_bounds
from paminsa_viz.synthesis.volume.solve import solve_volume
from paminsa_viz.synthesis.volume.surface import (
    VolumeSurface,
    _cause_at,
    cause_color,
    volume_glb,
    volume_stl,
    volume_surface,
    zero_surface,
)
from paminsa_viz.synthesis.volume.workspace import (
    RequirementCheck,
    Samples,
    reach_items,
    worst_over,
)
from tests.synthesis.robots import needs

GEOMETRY = APPENDIX_4.geometry
BOX, CYLINDER = WorkspaceShape.BOX, WorkspaceShape.CYLINDER


# ---------------------------------------------------------------- what contradicts


def test_the_fewest_requirements_that_nothing_meets() -> None:
    """Of any number of them; up to twelve the set is the smallest, of more an irreducible one."""
    met = np.ones((3, 8), bool)
    met[0, :4] = met[2, 4:] = False
    assert _conflict_of(met) == (0, 2)
    met[0, 0] = met[2, 7] = True
    assert _conflict_of(met) == ()
    many = np.ones((61, 40), bool)
    many[60] = np.arange(40) % 2 == 0
    many[3] = np.arange(40) % 2 == 1
    assert _conflict_of(many) == (3, 60)
    wide = np.ones((73, 2), bool)
    wide[0, 0] = False  # a pattern of more than eight bytes
    assert _conflict_of(wide) == ()
    for count, expected in ((12, (0,)), (13, (10, 11, 12))):  # the first, or the last three
        rows = np.ones((count, 9), bool)
        rows[0] = False
        rows[-3:] = ~np.repeat(np.eye(3, dtype=bool), 3, axis=1)
        assert _conflict_of(rows) == expected


def test_a_bound_moves_outward_on_the_side_that_breaks(monkeypatch: pytest.MonkeyPatch) -> None:
    volume: Any = SimpleNamespace(
        design=APPENDIX_4, requirements=Requirements((), (-0.2, 0.2)), headings=5
    )
    samples = Samples(np.zeros((1, 2)), np.array([-0.5]))
    for value, low, high in ((0.9, 0.5, 3.0), (1.0, 1.0, 3.5), (3.2, 1.0, 3.5)):
        monkeypatch.setattr(conflict, "worst_over", lambda *_, v=value: SimpleNamespace(value=v))
        moved = _moved(volume, Requirement("tau_1", low=1.0, high=3.0), samples, 0.5)
        assert (moved.low, moved.high) == (low, high)
    for low, high, moved_low, moved_high in (
        (-2.0, 2.0, -2.5, 2.5), (None, 2.0, None, 2.5), (-2.0, None, -2.5, None),
    ):  # fmt: skip
        one = Requirement("tau_1", low=low, high=high)
        assert _moved(volume, one, samples, 0.5) == replace(one, low=moved_low, high=moved_high)


def test_the_nearest_bound_is_where_all_others_are_met() -> None:
    axes = np.array([0.0, 0.1])
    volume: Any = SimpleNamespace(
        design=APPENDIX_4, headings=5, cause=np.zeros((2, 2, 2)), x=axes, y=axes + 1, z=axes - 1,
        requirements=needs("condition <= 5", "f_4 <= 400"),
    )  # fmt: skip
    held = np.array([[-3.0, -1.0, -0.5, -2.0, np.nan], [1.0, -0.1, -1e-9, 0.0, 1.0]])
    places = np.array([0, 3, 5, 6, 7])
    found = _relaxation(volume, None, held, places, 0)  # also where another is just met
    assert (found.requirement, found.by) == (0, 2.0)
    assert found.relaxed is not None
    assert found.relaxed.high == 7.0
    assert found.center == pytest.approx((0.1, 1.1, -1.0))
    none = _relaxation(volume, None, np.array([[-1.0, np.inf], [-1.0, -1.0]]), places[:2], 0)
    assert (none.by, none.relaxed, none.center) == (None, None, None)


# ---------------------------------------------------------------- causes and surfaces


def test_causes_have_their_codes_legs_and_words() -> None:
    found = causes_of(needs("condition <= 5", "f_4 <= 400"))
    assert [cause.code for cause in found] == list(range(len(found)))
    reach = [cause for cause in found if cause.kind is CauseKind.REACH]
    assert [cause.leg for cause in reach] == [0] * 4 + [1] * 4 + [2] * 4
    assert [cause.word for cause in reach[4:8]] == [f"{limit.word}:leg2" for limit in MARGINS]
    assert [cause.text for cause in reach[8:]] == [limit.reason(2) for limit in MARGINS]
    assert [cause.requirement for cause in found[-2:]] == [0, 1]
    assert [cause.word for cause in found[-2:]] == ["requirement1:condition", "requirement2:f_4"]


def test_a_requirement_counts_at_the_ends_of_its_ranges() -> None:
    bound = Requirement("condition", high=5.0, theta=(0.1, 0.2), z=(-0.6, -0.5))
    needed = Requirements((bound,), (-0.5, 0.5))
    for theta, z, expected in (
        (0.1 - 0.9e-9, -0.55, True), (0.1 - 1.1e-9, -0.55, False), (0.2 + 0.9e-9, -0.55, True),
        (0.2 + 1.1e-9, -0.55, False), (0.15, -0.6, True), (0.15, -0.5, True),
        (0.15, -0.6001, False), (0.15, -0.4999, False),
        (0.15 - 2 * np.pi, -0.55, True), (0.25 + 2 * np.pi, -0.55, False),
    ):  # fmt: skip
        assert counts(needed, bound, theta, z) is expected
    sizes = [
        bound_size(Requirement("tau_1", low=low, high=high))
        for low, high in ((-3.0, 5.0), (-7.0, 5.0), (None, -4.0), (0.0, 6.0), (0.0, None))
    ]
    assert sizes == [3.0, 5.0, 4.0, 6.0, 1.0]


def test_the_largest_number_of_faces_is_kept(monkeypatch: pytest.MonkeyPatch) -> None:
    x, y, z = np.meshgrid(*[np.arange(13.0)] * 3, indexing="ij")
    away = np.linalg.norm(np.stack([x, y, z], axis=-1) - 6.0, axis=-1)
    cause = np.where(away < 4.0, INSIDE, SINGULAR).astype(np.uint8)
    axes = 0.1 * np.arange(13.0)
    volume: Any = SimpleNamespace(
        depth=0.1 * (4.0 - away), cause=cause, nearest=np.full_like(cause, SINGULAR),
        causes=causes_of(Requirements(())), empty=False, cell=0.1,
        x=axes - 0.3, y=axes, z=axes - 1.0,
    )  # fmt: skip
    make = volume_surface.__wrapped__  # type: ignore[attr-defined]
    whole = make(volume, faces=100_000)
    center = np.array([0.3, 0.6, -0.4])
    assert np.linalg.norm(whole.vertices - center, axis=1) == pytest.approx(0.4, abs=0.01)
    assert (whole.cause == SINGULAR).all()
    few = make(volume, faces=len(whole.faces) // 2)
    assert 4 < len(few.faces) <= len(whole.faces) // 2
    assert np.linalg.norm(few.vertices - center, axis=1) == pytest.approx(0.4, abs=0.02)
    same = make(volume, faces=len(whole.faces))
    np.testing.assert_array_equal(same.vertices, whole.vertices)
    assert len(make(volume, faces=1).faces) >= 4
    asked: list[int] = []

    def simplify(points: Any, triangles: Any, *, target_count: int, **_: Any) -> Any:
        asked.append(target_count)
        return points, triangles, None

    monkeypatch.setattr(fast_simplification, "simplify", simplify)
    for most in (1, 4, 50, len(whole.faces)):
        make(volume, faces=most)
    assert asked == [4, 4, 50]


def test_what_cuts_is_named_by_the_node_outside_or_what_is_nearest() -> None:
    """Where reach ends a body, a requirement may end it before: within a cell from inside."""
    needed = needs("condition <= 5")
    causes = causes_of(needed)
    codes = {cause.kind: cause.code for cause in causes}
    broken, reach = codes[CauseKind.REQUIREMENT], FIRST_REACH
    cause = np.full((4, 1, 1), INSIDE, np.uint8)
    nearest = np.full((4, 1, 1), broken, np.uint8)
    volume: Any = SimpleNamespace(causes=causes, cell=0.1, cause=cause, nearest=nearest)
    for outside, depth, expected in (
        (broken, 0.5, broken), (broken, 0.05, broken), (reach, 0.05, broken), (reach, 0.5, reach),
        (reach, 0.1, reach), (SINGULAR, 0.05, broken), (SINGULAR, 0.5, SINGULAR),
        (INSIDE, 0.5, broken),
    ):  # fmt: skip
        for inner, outer in ((1, 2), (2, 1), (2, 3), (1, 0)):
            cause[:] = INSIDE
            cause[outer] = outside
            volume.depth = np.full((4, 1, 1), -1.0)
            volume.depth[inner] = depth
            at = np.array([[0.4 * inner + 0.6 * outer, 0.0, 0.0]])
            assert _cause_at(volume, at).tolist() == [expected]
    # at the edge of the grid the node outside is the last one
    cause[:] = INSIDE
    volume.depth = np.full((4, 1, 1), 0.5)
    assert _cause_at(volume, np.array([[3.4, 0.0, 0.0], [-0.4, 0.0, 0.0]])).tolist() == [broken] * 2


@pytest.mark.parametrize("size", [1.0, 1e-4])
def test_an_stl_has_normals_outward_and_none_of_a_face_without_area(size: float) -> None:
    """Of length 1, however small a face is."""
    x, y, z = np.meshgrid(*[np.arange(9.0)] * 3, indexing="ij")
    away = np.linalg.norm(np.stack([x, y, z], axis=-1) - 4.0, axis=-1)
    vertices, faces = zero_surface(3.0 - away)
    faces = np.concatenate([faces, [[0, 0, 1]]])
    surface = VolumeSurface(size * vertices, faces, np.zeros(len(vertices), np.uint8), ())
    data = volume_stl(surface)
    assert data[:80].rstrip() == b"paminsa_viz volume, millimeters"
    assert int.from_bytes(data[80:84], "little") == len(faces)
    kind = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("extra", "<u2")])
    rows = np.frombuffer(data[84:], kind)
    np.testing.assert_allclose(rows["corners"], 1e3 * size * vertices[faces], rtol=1e-6)
    assert (rows["extra"] == 0).all()
    assert rows["normal"][-1].tolist() == [0.0, 0.0, 0.0]
    normal = rows["normal"][:-1]
    large = np.linalg.norm(np.cross(
        vertices[faces[:-1, 1]] - vertices[faces[:-1, 0]],
        vertices[faces[:-1, 2]] - vertices[faces[:-1, 0]],
    ), axis=1) > 1e-3  # fmt: skip
    assert np.linalg.norm(normal[large], axis=1) == pytest.approx(1.0, abs=1e-5)
    outward = rows["corners"].mean(axis=1)[:-1] - 4e3 * size
    outward /= np.linalg.norm(outward, axis=1, keepdims=True)
    assert ((normal * outward).sum(axis=1)[large] > 0.7).all()


# ---------------------------------------------------------------- checks


def test_a_check_holds_where_all_items_do_and_not_at_the_best_poses() -> None:
    good = RequirementCheck("a", "m", 1.0, 1.0, None, True)
    bad = replace(good, holds=False)
    for items, over, expected in (
        ((good, good), Over.WORKSPACE, True), ((good, bad), Over.WORKSPACE, False),
        ((good,), Over.VOLUME, True), ((good,), Over.BEST, False),
    ):  # fmt: skip
        assert RequirementsCheck(items, over, None, None).holds is expected


def test_the_worst_of_reach_is_at_its_pose_and_a_guide_may_be_used_to_its_end() -> None:
    samples = Samples(np.array([[0.0, 0.0], [0.1, 0.0]]), np.array([-0.7, -0.5]))
    needed = Requirements((), (-0.3, 0.3))
    reach, singular = reach_items(APPENDIX_4, needed, samples)
    least = check_reach(GEOMETRY, np.array(reach.pose)).margins.min()
    assert reach.margin == pytest.approx(least, abs=1e-5)
    assert (reach.holds, reach.reason, reach.requirement) == (True, "", None)
    assert singular.pose is not None
    distance = measure_singularity(GEOMETRY, np.array(singular.pose)).position_distance
    assert singular.margin == pytest.approx(float(distance), abs=1e-6)
    # of some poses alone: without the worst it is another
    assert reach.pose is not None
    inside = (samples.positions[:, :1] != reach.pose[0]) & np.ones(2, bool)
    other = reach_items(APPENDIX_4, needed, samples, inside)[0]
    assert other.margin > reach.margin
    # a stroke that is just used up
    far = float(reach_bounds(GEOMETRY, 0.0, 0.0, (0.0, 0.0)).far)
    stroke = far / (GEOMETRY.magnification - 1)
    middle = Samples(np.zeros((1, 2)), np.array([-0.5]))
    for by, holds in ((1e-6, True), (-1e-6, False)):
        design = APPENDIX_4.vary({"geometry.guide_stroke": stroke + by})
        item = reach_items(design, Requirements((), (0.0, 0.0)), middle)[0]
        assert (item.holds, bool(item.reason)) == (holds, not holds)


def test_a_worst_value_is_at_its_pose_within_its_heights() -> None:
    bound = Requirement("f_4", high=400.0, z=(-0.62, -0.53))
    samples = Samples(np.array([[0.0, 0.0], [0.08, 0.02]]), np.array([-0.7, -0.6, -0.5]))
    theta = np.array([-0.2, 0.0, 0.2])
    found = worst_over(APPENDIX_4, bound, 3, samples, theta)
    z = np.array([-0.62, -0.6, -0.53])
    pose = Columns.at(samples.positions, theta, z).poses()
    value = static_torques(APPENDIX_4, pose)[..., 3]
    assert found.value == pytest.approx(value.max())
    assert found.margin == pytest.approx(400.0 - value.max())
    assert found.pose == pytest.approx(pose[np.unravel_index(value.argmax(), value.shape)])
    assert (found.requirement, found.unit, found.holds) == (3, "N", found.margin >= 0.0)
    above = worst_over(APPENDIX_4, replace(bound, z=(-0.5, -0.1)), 0, samples, theta)
    assert above.pose is not None
    assert above.pose[3] == -0.5
    nowhere = worst_over(APPENDIX_4, replace(bound, z=(-0.49, -0.1)), 0, samples, theta)
    assert (nowhere.pose, nowhere.holds, nowhere.margin) == (None, True, np.inf)
    far = worst_over(
        APPENDIX_4, Requirement("f_4", high=400.0), 0, Samples(np.array([[3.0, 0.0]]), z), theta
    )
    assert (far.holds, far.margin) == (False, -np.inf)
    assert far.reason.startswith("out of reach: leg ")


def test_the_search_for_a_center_starts_with_its_step_and_halves_it(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Along the free coordinates alone, to the best of the neighbors, as long as one is better."""
    asked: list[Any] = []
    top = np.array([0.31, 0.0, -0.47])

    def over(design: Any, requirements: Any, place: Any, fine: bool, *_: Any) -> Any:
        asked.append(place)
        assert not fine
        away = float(np.abs(np.array(place) - top).sum())
        item = RequirementCheck("a", "", 0.0, -away, None, True, "", 0)
        good = RequirementCheck("b", "", 0.0, 5.0, None, True, "", 0)
        return SimpleNamespace(items=(good, item))

    monkeypatch.setattr(check, "_over_workspace", over)
    space = Workspace(BOX, (0.1, 0.1, 0.1), (None, 0.0, None))
    needed = replace(needs("condition <= 5"), workspace=space)
    found = check._refined(APPENDIX_4, needed, (0.0, 0.0, -0.5), 0.2)
    assert asked[0] == (0.0, 0.0, -0.5)
    first = [(-0.2, 0.0, -0.5), (0.2, 0.0, -0.5), (0.0, 0.0, -0.7), (0.0, 0.0, -0.3)]
    assert [pytest.approx(one) for one in first] == asked[1:5]
    assert asked[6] == pytest.approx((0.4, 0.0, -0.5))
    assert len(asked) == 1 + 4 * 8
    assert np.abs(np.array(found) - top).sum() < 0.11
    # nowhere better: it stays, and looks nearer
    top = np.array([np.inf, 0.0, 0.0])
    asked.clear()
    assert check._refined(APPENDIX_4, needed, (0.0, 0.0, -0.5), 0.2) == (0.0, 0.0, -0.5)
    assert [asked[2 + 4 * n][0] for n in range(8)] == pytest.approx(0.2 * 0.5 ** np.arange(8.0))
    # from any node back to the axis: exactly
    top = np.array([0.0, 0.0, -0.5])
    solved = solve_volume(APPENDIX_4, needs("condition <= 5"), resolution=COARSE)
    for node in solved.x[np.abs(solved.x) < 3.5 * solved.cell]:
        start = (float(node), 0.0, -0.5)
        assert check._refined(APPENDIX_4, needed, start, solved.cell) == (0.0, 0.0, -0.5)


@pytest.mark.parametrize("nodes", [0, 1, 7])
def test_shares_are_of_the_nodes_that_can_be_reached(nodes: int) -> None:
    """Each requirement alone, as the only one that breaks, and each cause by the first of them."""
    volume = solve_volume(
        APPENDIX_4, needs("condition <= 4", "f_4 <= 300", "max_torque <= 6"), resolution=COARSE
    )
    places = np.argwhere(volume.reachable)[:: max(1, volume.reachable.sum() // 7)][:nodes]
    if nodes == 1:  # at which one requirement breaks
        places = np.argwhere(volume.reachable & ((~volume.met).sum(axis=0) == 1))[:1]
    few = np.zeros_like(volume.reachable)
    few[tuple(places.T)] = True
    part = replace(volume, reachable=few, reached_margins=volume.margins[:, few])
    broken = ~(volume.margins >= 0.0)[:, few]
    count = max(nodes, 1)
    alone = 1.0 - (~broken).sum(axis=1) / count
    assert part.removed_alone == pytest.approx(alone)
    last = [(broken[i] & (broken.sum(axis=0) == 1)).sum() / count for i in range(3)]
    assert part.removed_last == pytest.approx(last)
    codes, counts_ = np.unique(volume.cause[few], return_counts=True)
    shares = {volume.causes[code]: n / count for code, n in zip(codes, counts_, strict=True)}
    assert part.shares() == pytest.approx(shares)
    assert volume.reachable_share == pytest.approx(volume.volume / volume.reachable_volume)
    assert np.isnan(replace(volume, reachable_volume=0.0).reachable_share)


def test_a_glb_has_the_volume_upright_below_one_node() -> None:
    """In glTF y is up, and z toward the one who looks."""
    needed = needs("condition <= 5")
    vertices = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 3.0]])
    vertices = np.concatenate([vertices, vertices[:1]])  # one twice, which stays so
    faces = np.array([[0, 2, 1], [0, 1, 3], [4, 3, 2], [1, 2, 3]])
    surface = VolumeSurface(vertices, faces, np.full(5, SINGULAR, np.uint8), causes_of(needed))
    data = io.BytesIO(volume_glb(surface))
    scene: Any = trimesh.load(data, file_type="glb", process=False)
    turn, _ = scene.graph.get("volume")
    expected = np.array([[1, 0, 0, 0], [0, 0, 1, 0], [0, -1, 0, 0], [0, 0, 0, 1]])
    np.testing.assert_allclose(turn, expected, atol=1e-12)
    (geometry,) = scene.geometry.values()
    assert np.sort(geometry.extents).tolist() == [1.0, 2.0, 3.0]
    assert len(geometry.vertices) == 5
    np.testing.assert_allclose(np.sort(scene.extents), [1.0, 2.0, 3.0])
    np.testing.assert_allclose(scene.extents, [1.0, 3.0, 2.0])
    # in the color of the page, opaque, seen from both sides, and dull as other drawings are
    material = geometry.visual.material
    color = (*palette.rgb(cause_color(surface.causes[SINGULAR])), 255)
    assert tuple(material.baseColorFactor) == color
    assert (material.metallicFactor, material.doubleSided) == (0.0, True)
    assert 0.7 <= material.roughnessFactor <= 0.8


@pytest.mark.parametrize("which", range(4))
def test_reach_without_a_margin_holds_at_the_end_of_a_guide_only(
    monkeypatch: pytest.MonkeyPatch, which: int
) -> None:
    bounds = SimpleNamespace(
        margin=lambda z: (np.zeros((1, 1)), np.array([[which + 4]], np.uint8)),
        position=np.ones((1, 1)), turn=1.0, regular=np.ones((1, 1), bool),
    )  # fmt: skip
    monkeypatch.setattr(workspace, "reach_bounds", lambda *_: bounds)
    middle = Samples(np.zeros((1, 2)), np.array([-0.5]))
    item = reach_items(APPENDIX_4, Requirements((), (0.0, 0.0)), middle)[0]
    guide = MARGINS[which] is Limit.GUIDE
    assert item.holds is guide
    assert item.reason == ("" if guide else MARGINS[which].reason(1))


def test_what_takes_no_pose_is_looked_at_in_the_middle_where_it_is_least_short() -> None:
    z = np.array([-0.9, -0.6, -0.3])
    needed = Requirements((Requirement("f_4", high=400.0),), (-np.pi, np.pi))
    volume: Any = SimpleNamespace(design=APPENDIX_4, requirements=needed, z=z)
    reach, singular, broken = check._nothing(volume)
    least = reach_bounds(GEOMETRY, 0.0, 0.0, needed.theta).margin(z)[0]
    for item in (reach, singular):
        assert item.pose is not None
        assert (item.pose[0], item.pose[1], item.pose[3]) == (0.0, 0.0, z[least.argmax()])
    assert reach.margin == pytest.approx(least.max())
    assert (broken.margin, broken.holds, broken.requirement) == (-np.inf, False, 0)


@pytest.mark.parametrize(("fine", "count"), [(False, 5), (True, 65)])
def test_a_fine_check_looks_at_four_times_as_many_headings_as_a_volume(
    monkeypatch: pytest.MonkeyPatch, fine: bool, count: int
) -> None:
    asked: list[Any] = []
    item = RequirementCheck("a", "", 0.0, 1.0, None, True)
    monkeypatch.setattr(check, "reach_items", lambda *_: (item, item))
    monkeypatch.setattr(check, "worst_over", lambda *given: asked.append(given) or item)
    space = Workspace(BOX, (0.1, 0.1, 0.1), (0.0, 0.0, -0.5))
    needed = replace(needs("condition <= 5"), workspace=space)
    check.check_requirements(APPENDIX_4, needed, fine=fine)
    (_, _, _, samples, theta) = asked[0]
    assert len(theta) == count == (4 * (FINE.headings - 1) + 1 if fine else COARSE.headings)
    assert len(samples.z) == 2 * (8 if fine else 3) + 1
