"""Tubes around the center lines of a mode."""

from __future__ import annotations

import numpy as np
import pytest

from paminsa_viz.meshes.vibrating import SIDES, tubes


def test_a_tube_is_round_and_faces_outward_whichever_way_it_runs() -> None:
    ways = np.concatenate([np.eye(3), -np.eye(3), [[0.0, 0.6, 0.8], [0.0, -0.1, -1.0]]])
    lines = np.linspace(0.0, 1.0, 3)[None, :, None] * ways[:, None] + [0.1, 0.2, -0.5]
    vertices, faces = tubes(lines, 0.01)
    out = vertices - lines[:, :, None]
    assert np.linalg.norm(out, axis=-1) == pytest.approx(np.full(out.shape[:3], 0.01))
    across = np.einsum("npsi,ni->nps", out, ways)
    assert across == pytest.approx(np.zeros_like(across), abs=1e-15)
    corners, away = vertices.reshape(-1, 3)[faces], out.reshape(-1, 3)[faces].mean(axis=1)
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    assert (np.einsum("fi,fi->f", normal, away) > 0).all()
    assert len(np.unique(np.sort(faces), axis=0)) == len(faces) == 2 * 2 * SIDES * len(lines)
