"""Catalogs of motors, gears, screws and belts that drives can be made of."""

from __future__ import annotations

from dataclasses import dataclass

from paminsa_viz.actuation.drive_table import DriveTable, pair_table
from paminsa_viz.errors import TableFileError
from paminsa_viz.model.drive import Drive


class CatalogError(TableFileError):
    """A catalog that cannot be used."""


@dataclass(frozen=True)
class Catalog:
    """Parts that drives can be made of.

    Attributes:
        name: Of the file.
        motors, gears, transmissions: `Drive` objects of which only that part counts. The inertia
            and friction of gears are at their input, those of screws and belts at their own shaft.
        sources: Where the values of each part are from, by its name.
    """

    name: str
    motors: tuple[Drive, ...]
    gears: tuple[Drive, ...]
    transmissions: tuple[Drive, ...]
    sources: dict[str, str]

    def pairs(self, actuator: int) -> DriveTable:
        """Return every motor with every gear as columns, for M4 (3) with every screw and belt.

        Raises:
            CatalogError: If the catalog lacks what the actuator needs.
        """
        lacking = [
            kind for kind, parts in (("motor", self.motors), ("gear", self.gears)) if not parts
        ]
        if actuator == 3 and not self.transmissions:
            lacking.append("screw or belt")
        if lacking:
            raise CatalogError(self.name, f"it has no {' and no '.join(lacking)}")
        screws = self.transmissions if actuator == 3 else ()
        return pair_table(self.motors, self.gears, screws)
