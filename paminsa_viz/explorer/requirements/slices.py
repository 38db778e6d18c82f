"""Requirements on a map: which cells break which one, at the map's heading and height."""

from __future__ import annotations

from paminsa_viz.explorer.requirements.causes import cause_groups
from paminsa_viz.model import Design
from paminsa_viz.model.grids import Field
from paminsa_viz.model.reach import Limit
from paminsa_viz.plots.outside import Outside
from paminsa_viz.quantities.requirements import Requirements
from paminsa_viz.synthesis.volume.causes import cause_slice


def outside_of(field: Field, design: Design, requirements: Requirements) -> Outside:
    """Return which cells of a solved map break a requirement, and which one the most.

    Cells that cannot be reached are not among them; maps show those in another way.
    """
    (_, y), (_, x) = field.grid.axes
    theta, z = field.grid.fixed[2:]
    found = cause_slice(design, requirements, x, y, float(theta), float(z), field=field)
    groups, index = cause_groups(found.causes)
    code = index[found.cause]
    code[(field.status != Limit.OK) | ~found.broken.any(axis=0)] = 0
    return Outside(
        code, tuple(group.text for group in groups), tuple(group.color for group in groups)
    )
