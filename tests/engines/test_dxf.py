"""The drawing: audited by ezdxf, with the design's lengths in millimeters."""

from __future__ import annotations

import io
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from paminsa_viz.engines.dxf import dxf_text
from paminsa_viz.errors import UnreachablePose
from paminsa_viz.model import APPENDIX_4, inverse_kinematics
from paminsa_viz.model.design import Design
from tests.support import samples

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


def test_the_note_says_design_and_pose_in_plain_letters() -> None:
    drawing = drawn(replace(APPENDIX_4, name="Prüfling %%u"), (0.05, 0.0, 0.0, -0.55))
    notes = [text.dxf.text for text in drawing.modelspace().query("TEXT")]
    assert any(text.startswith("Pr?fling ?u: x 50 mm") for text in notes)


def test_a_pose_out_of_reach_is_refused() -> None:
    with pytest.raises(UnreachablePose, match="cannot close"):
        dxf_text(APPENDIX_4, pose=[2.0, 0.0, 0.0, -0.5])
