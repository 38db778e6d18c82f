"""Reading and writing files: designs as TOML, tables of poses as CSV.

What scripts need are `load_design` and `save_design`, `read_log`, `read_measurements`,
`read_trajectory` and `load_catalog`, and `save_table`. Nothing here computes a robot; these modules
turn text into the model's types and back, and name the file, the line or row, and the key or column
of whatever they refuse.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from paminsa_viz.late import late_names

if TYPE_CHECKING:
    from paminsa_viz.errors import FileError, TableFileError
    from paminsa_viz.files.design_file import DesignContent, load_content, load_design, save_design
    from paminsa_viz.files.drive_catalog import generic_catalog, load_catalog, read_catalog
    from paminsa_viz.files.errors import DesignFileError
    from paminsa_viz.files.example_designs import ExampleDesign, example_design
    from paminsa_viz.files.example_logs import ExampleLog, example_log
    from paminsa_viz.files.logs import log_table, read_log
    from paminsa_viz.files.measurements import (
        MeasurementTable,
        measurement_table,
        read_measurements,
    )
    from paminsa_viz.files.published_table import (
        PublishedMap,
        PublishedTorques,
        read_published,
        read_published_map,
    )
    from paminsa_viz.files.tables import DataTable, provenance, save_table, table_bytes, table_csv
    from paminsa_viz.files.trajectory_table import analysis_table, read_trajectory, simulation_table

__all__ = [
    "DataTable",
    "DesignContent",
    "DesignFileError",
    "ExampleDesign",
    "ExampleLog",
    "FileError",
    "MeasurementTable",
    "PublishedMap",
    "PublishedTorques",
    "TableFileError",
    "analysis_table",
    "example_design",
    "example_log",
    "generic_catalog",
    "load_catalog",
    "load_content",
    "load_design",
    "log_table",
    "measurement_table",
    "provenance",
    "read_catalog",
    "read_log",
    "read_measurements",
    "read_published",
    "read_published_map",
    "read_trajectory",
    "save_design",
    "save_table",
    "simulation_table",
    "table_bytes",
    "table_csv",
]

__getattr__ = late_names(__name__)
