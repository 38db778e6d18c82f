"""Maps: what they hold in numbers, and by how much computed torques are off published ones."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from paminsa_viz.blocks.data import robot
from paminsa_viz.blocks.kinds import Block, Note, Table, rows
from paminsa_viz.files.columns import TORQUES as TORQUE_NAMES
from paminsa_viz.files.published_table import PublishedMap
from paminsa_viz.model import solve_field, static_torques, xy_grid
from paminsa_viz.model.arrays import Array
from paminsa_viz.model.reach import Limit, status_words
from paminsa_viz.model.singular_limit import counting, serial_clearance
from paminsa_viz.plots.map_values import MapData
from paminsa_viz.quantities import TORQUES
from paminsa_viz.units import counted, format_value, number, si_unit


def maps_data(
    data: MapData,
    keys: Sequence[str],
    max_condition: float,
    published: PublishedMap | None = None,
) -> dict[str, Any]:
    """Return what maps hold, for `maps_blocks` and for JSON, in SI units.

    Args:
        data: The maps.
        keys: Keys of the quantities.
        max_condition: Largest condition number of a position that counts.
        published: Torques from elsewhere, to compare with.
    """
    reached = data.status == Limit.OK
    leg = np.full(data.status.shape, -1, np.int8) if data.leg is None else data.leg
    words, cells = np.unique(status_words(data.status, leg), return_counts=True)
    cell = float((data.x[1] - data.x[0]) * (data.y[1] - data.y[0]))
    counts = _counting(data, max_condition)
    facts = {
        **robot(data.design),
        "reference": data.reference and data.reference.name,
        "theta_rad": data.theta,
        "z_m": data.z,
        "cells": [data.x.size, data.y.size],
        "reached_area_m2": cell * int(reached.sum()),
        "singular_radius_m": data.singular_radius,
        "cells_by_status": dict(zip(words.tolist(), cells.tolist(), strict=True)),
        "unit": si_unit(data.unit),
        "max_condition": max_condition,
        "counting_cells": int(counts.sum()),
        "maps": {
            name: _numbers(values, counts) for name, values in zip(keys, data.values, strict=True)
        },
    }
    return facts if published is None else facts | {"published": off_published(data, published)}


def off_published(data: MapData, published: PublishedMap) -> dict[str, dict[str, float | int]]:
    """Return by how much computed torques are off published ones, by columns that have any.

    Largest and RMS differences over the positions that can be reached [N m, N].
    """
    rest = np.broadcast_to([data.theta, data.z], published.position.shape)
    off = static_torques(data.design, np.hstack([published.position, rest])) - published.torque
    found: dict[str, dict[str, float | int]] = {}
    for name, column in zip(TORQUE_NAMES, off.T, strict=True):
        known = column[np.isfinite(column)]
        if known.size:
            found[name] = {
                "positions": known.size,
                "largest_difference": float(np.abs(known).max()),
                "rms_difference": float(np.sqrt(np.mean(known**2))),
            }
    return found


def _counting(data: MapData, limit: float) -> NDArray[np.bool_]:
    """Return which cells are not too close to a singularity, for a difference of both designs."""
    grid = xy_grid(data.x, data.y, data.theta, data.z)
    designs = [data.design] if data.reference is None else [data.design, data.reference]
    return np.all([counting(solve_field(d.geometry, grid), limit) for d in designs], axis=0)


def _numbers(values: Array, counts: NDArray[np.bool_]) -> dict[str, float]:
    """Return extremes, and percentiles of the size, over the cells that count; NaN without any."""
    known = values[counts & np.isfinite(values)]
    if not known.size:
        return dict.fromkeys(("least", "largest", "median_size", "p90_size"), np.nan)
    median, most = np.percentile(np.abs(known), (50, 90))
    return {
        "least": float(known.min()),
        "largest": float(known.max()),
        "median_size": float(median),
        "p90_size": float(most),
    }


def maps_blocks(data: MapData, facts: dict[str, Any]) -> list[Block]:
    """Return where maps are, what they hold, and how far they are off published values.

    Args:
        data: The maps.
        facts: What `maps_data` says of them.
    """
    minus = "" if data.reference is None else f' minus "{data.reference.name}"'
    factor, unit = data.display
    size = "|tau|" if tuple(facts["maps"]) == TORQUES else "size"
    head = (f"[{unit}]" if unit else "", "Least", "Largest", f"Median {size}", f"90 % of {size} <")
    cells = (
        (name, *(number(value * factor) for value in found.values()))
        for name, found in facts["maps"].items()
    )
    clearance = format_value(serial_clearance(data.design.geometry), "m", 3)
    counting = counted(facts["counting_cells"], "cell that counts", "cells that count")
    circle = (
        "none"
        if data.singular_radius is None
        else (f"radius {format_value(data.singular_radius, 'm')}")
    )
    return [
        Note(f'design "{data.design.name}"{minus}, {data.design.geometry.knee.label}'),
        Note(
            f"θ = {format_value(data.theta, 'rad', 6)}, z = {format_value(data.z, 'm', 6)}, "
            f"{data.x.size} × {data.y.size} cells"
        ),
        Table(head, rows(*cells), literal=True),
        Note(
            f"over the {counting}: not too close to a singularity "
            f"(condition number at most {facts['max_condition']:g}, {clearance} to a stretched or "
            "folded leg)"
        ),
        Note(f"reached: {number(facts['reached_area_m2'])} m²; singular circle: {circle}"),
        *(
            Note(
                f"{name} − published: {number(off['largest_difference'])} at most, "
                f"{number(off['rms_difference'])} RMS over {counted(off['positions'], 'position')}"
            )
            for name, off in facts.get("published", {}).items()
        ),
    ]
