"""Our solids as shapes of coal, an independent collision library."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from paminsa_viz.clearance.nearest import BOX, CAPSULE, CYLINDER
from paminsa_viz.clearance.solids import Primitive


def coal_request() -> Any:
    """Return a request of signed distances, as exact as coal has them."""
    request = pytest.importorskip("coal").DistanceRequest()
    request.gjk_tolerance, request.gjk_max_iterations = 1e-13, 1000
    request.epa_tolerance, request.epa_max_iterations = 1e-12, 500
    request.enable_signed_distance = True
    return request


def coal_shape(solid: Primitive) -> Any:
    """Return a solid about its own origin."""
    coal: Any = pytest.importorskip("coal")
    if solid.kind == CAPSULE:
        return coal.Capsule(solid.radius, 2 * solid.size[2])
    if solid.kind == BOX:
        return coal.Box(*(2 * solid.size))
    if solid.kind == CYLINDER:
        return coal.Cylinder(solid.size[0], 2 * solid.size[2])
    points = coal.StdVec_Vec3s()
    for height in (-solid.size[2], solid.size[2]):
        for corner in solid.corners:
            points.append(np.array([*corner, height]))
    return coal.ConvexBase.convexHull(points, False, "")
