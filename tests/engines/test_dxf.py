"""The drawing: audited by ezdxf, with the design's lengths in millimeters."""

from __future__ import annotations

import io
from dataclasses import replace
from itertools import pairwise
from typing import Any

import numpy as np
import pytest

from paminsa_viz.engines.dxf import GAP, LAYERS, dxf_text
from paminsa_viz.errors import UnreachablePose
from paminsa_viz.model import APPENDIX_4, inverse_kinematics
from paminsa_viz.model.design import Design
from paminsa_viz.version import MADE_BY
from tests.support import samples
from tests.support.documentation import missing

ezdxf = pytest.importorskip("ezdxf", reason="ezdxf comes with the extra 'test'")

EACH = samples.each_robot((7,))


def drawn(design: Design, pose: Any) -> Any:
    drawing = ezdxf.read(io.StringIO(dxf_text(design, pose=list(pose))))
    audit = drawing.audit()
    assert not audit.errors
    assert not audit.fixes
    return drawing


def lengths(drawing: Any, layer: str) -> list[float]:
    lines = drawing.modelspace().query(f'LINE[layer=="{layer}"]')
    return [line.dxf.start.distance(line.dxf.end) for line in lines]


@EACH
def test_each_leg_has_its_bars_in_true_length(design: Design) -> None:
    g = design.geometry
    drawing = drawn(design, samples.random_poses(np.random.default_rng(5), design, 1)[0])
    assert drawing.units == 4  # millimeters
    for leg in (1, 2, 3):
        found = lengths(drawing, f"LEG_{leg}")
        for length in (
            g.crank_length, g.crank_length, g.coupler_length, g.short_coupler_length,
            g.shaft_length, g.guide_link_length,
        ):  # fmt: skip
            nearest = min(found, key=lambda value, length=length: abs(value - 1e3 * length))
            assert nearest == pytest.approx(1e3 * length, rel=1e-9)
            found.remove(nearest)


def test_from_above_joints_stand_where_the_robot_has_them() -> None:
    pose = np.array([0.05, -0.03, 0.3, -0.55])
    circles = drawn(APPENDIX_4, pose).modelspace().query('CIRCLE[layer=="FROM_ABOVE"]')
    centers = np.array([(circle.dxf.center.x, circle.dxf.center.y) for circle in circles])
    points = inverse_kinematics(APPENDIX_4.geometry, pose).points
    for number in (2, 3, 4, 5, 7, 8, 9):
        for point in 1e3 * np.asarray(points[number])[:, :2]:
            assert np.linalg.norm(centers - point, axis=1).min() < 1e-6, number


def test_legs_stand_side_by_side_each_about_the_cross_on_its_axis() -> None:
    """Joints are where they are in the leg's plane, and gaps are a share of the first view."""
    pose = np.array([0.05, -0.03, 0.3, -0.55])
    drawing = drawn(APPENDIX_4, pose)
    configuration = inverse_kinematics(APPENDIX_4.geometry, pose)
    space = drawing.modelspace()
    spans, lowest = [], np.inf
    for layer in ("FROM_ABOVE", "LEG_1", "LEG_2", "LEG_3"):
        lines = np.array(
            [
                [(end.x, end.y) for end in (line.dxf.start, line.dxf.end)]
                for line in space.query(f'LINE[layer=="{layer}"]')
            ]
        )
        circles = space.query(f'CIRCLE[layer=="{layer}"]')
        centers = np.array([(circle.dxf.center.x, circle.dxf.center.y) for circle in circles])
        (radius,) = {round(circle.dxf.radius, 9) for circle in circles}
        ways = lines[:, 1] - lines[:, 0]
        for center in centers:  # each joint is on a line
            share = ((center - lines[:, 0]) * ways).sum(axis=1) / (ways**2).sum(axis=1)
            off = lines[:, 0] + np.clip(share, 0.0, 1.0)[:, None] * ways - center
            assert np.hypot(*off.T).min() < 1e-5
        g = APPENDIX_4.geometry
        assert radius < 0.02 * 1e3 * (g.crank_length + g.coupler_length)
        if layer != "FROM_ABOVE":
            ways = lines[:, 1] - lines[:, 0]
            across, up = (
                np.flatnonzero((np.abs(ways - 6 * radius * way) < 1e-6).all(axis=1))
                for way in np.eye(2)
            )
            assert (len(across), len(up)) == (1, 1)
            cross, same = (lines[rows[0]].mean(axis=0) for rows in (across, up))
            np.testing.assert_allclose(cross, same, atol=1e-9)
            assert cross[1] == pytest.approx(0.0, abs=1e-9)  # z = 0
            leg = int(layer[-1]) - 1
            axis = configuration.points[3][leg, :2]
            beta = configuration.beta[leg]
            for number in (3, 4, 5, 7, 8, 9):
                x, y, z = configuration.points[number][leg]
                along = (x - axis[0]) * np.cos(beta) + (y - axis[1]) * np.sin(beta)
                away = np.abs(centers - cross - 1e3 * np.array([along, z])).max(axis=1)
                assert away.min() < 1e-5, (layer, number)
            lines = np.delete(lines, [across[0], up[0]], axis=0)
        name = next(text for text in space.query("TEXT") if text.dxf.text == layer)
        assert name.dxf.layer == "NOTES"
        assert name.dxf.insert.x == pytest.approx(lines[..., 0].min())
        assert name.dxf.insert.y == pytest.approx(lines[..., 1].min() - 6 * radius)  # below it
        assert name.dxf.height == pytest.approx(2 * radius)
        spans.append((lines[..., 0].min(), lines[..., 0].max()))
        lowest = min(lowest, lines[..., 1].min())
    first = spans[0][1] - spans[0][0]
    for before, after in pairwise(spans):
        assert after[0] - before[1] == pytest.approx(GAP * first)
    *names, note = sorted(space.query("TEXT"), key=lambda text: -text.dxf.insert.y)
    assert len(names) == 4
    assert note.dxf.insert.x == pytest.approx(spans[0][0])
    assert note.dxf.text.endswith(MADE_BY)
    assert note.dxf.height == pytest.approx(2 * radius)
    assert note.dxf.insert.y == pytest.approx(lowest - 10 * radius)  # below their names
    assert {layer.dxf.name: layer.dxf.color for layer in drawing.layers}.items() >= LAYERS.items()


def test_the_note_says_design_and_pose_in_plain_letters() -> None:
    drawing = drawn(replace(APPENDIX_4, name="Prüfling %%u"), (0.05, 0.0, 0.0, -0.55))
    notes = [text.dxf.text for text in drawing.modelspace().query("TEXT")]
    assert any(text.startswith("Pr?fling ?u: x 50 mm") for text in notes)


def test_legs_are_red_green_and_blue_and_places_are_flat() -> None:
    said = "legs are red, green and blue, notes are gray, and circles at the joints have a radius"
    assert missing("drawn-sizes", [f"{said} of 1.2 % of crank plus coupler"]) == []
    red, green, blue, gray, either = (ezdxf.colors.aci2rgb(code) for code in (1, 3, 5, 8, 7))
    assert (red, green, blue, either) == ((255, 0, 0), (0, 255, 0), (0, 0, 255), (255, 255, 255))
    assert len(set(gray)) == 1
    text = dxf_text(APPENDIX_4)
    assert "-0.0\n" not in text  # a zero has no sign
    colors = {
        layer.dxf.name: ezdxf.colors.aci2rgb(layer.dxf.color)
        for layer in ezdxf.read(io.StringIO(text)).layers
        if layer.dxf.name in LAYERS
    }
    assert colors == {
        "FROM_ABOVE": either, "LEG_1": red, "LEG_2": green, "LEG_3": blue, "NOTES": gray,
    }  # fmt: skip
    g = APPENDIX_4.geometry
    lines = [line.strip() for line in text.splitlines()]
    pairs = list(zip(map(int, lines[::2]), lines[1::2], strict=True))
    starts = [number for number, (code, _) in enumerate(pairs) if code == 0]
    point = [10, 20, 30]
    wanted = {
        "LINE": [8, *point, 11, 21, 31], "CIRCLE": [8, *point, 40], "TEXT": [8, *point, 40, 1],
    }  # fmt: skip
    kinds = set()
    for start, end in pairwise(starts):
        kind, inside = pairs[start][1], pairs[start + 1 : end]
        if kind in wanted:
            kinds.add(kind)
            assert [code for code, _ in inside] == wanted[kind]
            assert {value for code, value in inside if code in (30, 31)} == {"0.0"}
        if kind == "CIRCLE":
            radius = float(inside[-1][1])
            assert radius == pytest.approx(12.0 * (g.crank_length + g.coupler_length))
            if inside[0][1] == "FROM_ABOVE":  # joints that are one but for rounding are one
                places = [1e6 * float(value) for _, value in inside[1:3]]
                np.testing.assert_allclose(places, np.round(places), atol=1e-3)
    assert kinds == set(wanted)


def test_tables_say_how_many_layers_there_are_and_of_which_kind() -> None:
    lines = [line.strip() for line in dxf_text(APPENDIX_4).splitlines()]
    pairs = list(zip(map(int, lines[::2]), lines[1::2], strict=True))
    head = pairs[: pairs.index((2, "ENTITIES"))]
    assert [value for code, value in head if code == 0] == [
        "SECTION", "ENDSEC", "SECTION", "TABLE", *["LAYER"] * len(LAYERS), "ENDTAB", "ENDSEC",
        "SECTION",
    ]  # fmt: skip
    assert pairs[-2:] == [(0, "ENDSEC"), (0, "EOF")]
    table = head.index((0, "TABLE"))
    assert head[table + 1 : table + 3] == [(2, "LAYER"), (70, str(len(LAYERS)))]
    assert head[1:6] == [
        (2, "HEADER"), (9, "$ACADVER"), (1, "AC1009"), (9, "$INSUNITS"), (70, "4"),
    ]  # fmt: skip
    for name in LAYERS:
        place = head.index((2, name))
        assert [head[place - 1], head[place + 1], head[place + 3]] == [
            (0, "LAYER"), (70, "0"), (6, "CONTINUOUS"),
        ]  # fmt: skip


def test_a_pose_out_of_reach_is_refused() -> None:
    with pytest.raises(UnreachablePose, match="cannot close"):
        dxf_text(APPENDIX_4, pose=[2.0, 0.0, 0.0, -0.5])
