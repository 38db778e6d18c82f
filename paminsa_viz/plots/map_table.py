"""Maps as tables, in SI units, with where they come from."""

from __future__ import annotations

from typing import Any
from unicodedata import normalize

import numpy as np
from numpy.typing import NDArray

from paminsa_viz.files.columns import POSE, STATUS
from paminsa_viz.files.tables import DataTable, provenance
from paminsa_viz.files.trajectory_table import parameter_facts, robot_facts
from paminsa_viz.model.reach import Limit, status_words
from paminsa_viz.plots.caption import key_numbers
from paminsa_viz.plots.map_values import MapData
from paminsa_viz.units import si_unit

FORMAT = "paminsa_viz map 1"
"""Name and version of the layout."""

_LETTERS = {"τ": "tau", "κ": "kappa", "Δ": "delta_", "θ": "theta", " ": "_", "_": "_"}
_UNITS = {"N·m": "Nm", "N m": "Nm", "1": ""}


def map_table(data: MapData) -> DataTable:
    """Return a map as a table of one row a cell, along x first.

    The columns are the pose of the cell, the values (NaN where there is none) and the status in
    words, such as ``ok`` or ``stretched:leg2``, or why a pose that can be taken has no value.

    A binary file holds arrays instead: ``x_m`` (nx,), ``y_m`` (ny,), one (ny, nx) array for each of
    `value_columns`, ``status`` (ny, nx) codes, ``status_words`` their names by code, ``leg``
    (ny, nx) if known (index of the leg in the way, -1 for none), ``pose`` (4,) [m, m, rad, m].
    """
    values = dict(zip(value_columns(data), data.values, strict=True))
    missing = data.missing
    x, y = np.meshgrid(data.x, data.y)
    theta, z = (np.full(x.shape, value) for value in data.pose[2:])
    words = status_words(data.status, -1 if data.leg is None else data.leg)
    if missing is not None:
        known = (data.status != Limit.OK) | (missing.code == 0)
        words = np.where(known, words, np.array(missing.words)[missing.code])
    columns = dict(zip(POSE, (x, y, theta, z), strict=True)) | values | {STATUS: words}
    arrays: dict[str, NDArray[Any]] = {"x_m": data.x, "y_m": data.y, **values}
    arrays |= {STATUS: data.status, "status_words": np.array([limit.word for limit in Limit])}
    arrays |= {} if data.leg is None else {"leg": data.leg}
    return DataTable(columns, provenance(FORMAT, _facts(data)), arrays | {"pose": data.pose})


def value_columns(data: MapData) -> tuple[str, ...]:
    """Return the column names of the values, in plain letters, with their unit: ``tau1_Nm``."""
    unit = si_unit(_UNITS.get(data.unit, data.unit))
    names = [_plain(name) + (f"_{unit}" if unit else "") for name in data.names]
    return tuple(
        name if names.count(name) == 1 else f"{name}_{i + 1}" for i, name in enumerate(names)
    )


def _facts(data: MapData) -> dict[str, str]:
    facts = {
        "title": data.title,
        "unit": si_unit(data.unit),
        **robot_facts(data.design, equal_legs=not data.own_legs),
    }
    names = ("pose x [m]", "pose y [m]", "pose theta [rad]", "pose z [m]")
    facts |= dict(zip(names, map(repr, data.pose.tolist()), strict=True))
    if data.singular_radius is not None:
        facts["singular radius [m]"] = repr(float(data.singular_radius))
    for symbol, value, unit in key_numbers(data.design):
        facts[f"{normalize('NFKC', symbol)} [{unit}]"] = repr(float(value))  # Mp2, as in a sweep
    facts |= parameter_facts(data.design)
    if data.reference is not None:
        facts["reference"] = data.reference.name
        facts |= parameter_facts(data.reference, "reference")
    return facts


def _plain(name: str) -> str:
    """Return a name in small ASCII letters and digits."""
    digits = str.maketrans("₀₁₂₃₄₅₆₇₈₉", "0123456789")
    text = "".join(_LETTERS.get(c, c) for c in name.translate(digits)).lower()
    kept = "".join(c for c in text if c == "_" or (c.isascii() and c.isalnum()))
    return kept.strip("_") or "value"
