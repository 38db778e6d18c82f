"""Flags of commands about requirements: of a design file, and as text."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Annotated

import tyro

from paminsa_viz.cli.arguments import UsageError
from paminsa_viz.cli.flags import DesignFlags, Point
from paminsa_viz.files.design_file import load_content
from paminsa_viz.model.design import Design
from paminsa_viz.quantities.requirement_text import parse_requirement
from paminsa_viz.quantities.requirements import Requirements, Workspace, WorkspaceShape
from paminsa_viz.units import MM


@dataclass(frozen=True, kw_only=True)
class RequirementFlags(DesignFlags):
    """The robot and what it is needed for."""

    file: Annotated[Path | None, tyro.conf.Positional, tyro.conf.arg(metavar="FILE")] = None
    """Design file with its requirements; Appendix 4 if left out."""
    require: Annotated[tuple[str, ...], tyro.conf.arg(metavar="TEXT")] = ()
    """A requirement on top of the file's; may be given several times."""
    theta: Annotated[tuple[float, float] | None, tyro.conf.arg(metavar="FROM TO")] = None
    """Headings that count [degrees], instead of the file's."""
    cylinder: Annotated[tuple[float, float] | None, tyro.conf.arg(metavar="DIAMETER HEIGHT")] = None
    """A cylinder that has to fit [mm], instead of the file's workspace."""
    box: Annotated[Point | None, tyro.conf.arg(metavar="X Y Z")] = None
    """A box that has to fit [mm], instead of the file's workspace."""
    center: Annotated[tuple[str, str, str] | None, tyro.conf.arg(metavar="X Y Z")] = None
    """Center of the workspace [mm]; 'free' for a coordinate that is to be found. 0 0 free if left
    out."""

    def given(self) -> tuple[Design, Requirements]:
        """Return the design and its requirements.

        Raises:
            UsageError: If flags exclude each other or a number is none.
            DesignFileError: If the file cannot be read or is refused.
        """
        if self.file is not None and self.design is not None:
            raise UsageError("FILE and --design exclude each other")
        path = self.file or self.design
        design = replace(self, design=path).given_design()
        given = None if path is None else load_content(path).requirements
        return design, self._requirements(given or Requirements())

    def _requirements(self, given: Requirements) -> Requirements:
        bounds = (*given.bounds, *map(parse_requirement, self.require))
        low, high = given.theta
        if self.theta is not None:
            low, high = map(math.radians, self.theta)
        return Requirements(bounds, (low, high), self._workspace(given.workspace))

    def _workspace(self, given: Workspace | None) -> Workspace | None:
        if self.cylinder is not None and self.box is not None:
            raise UsageError("--cylinder and --box exclude each other")
        if self.cylinder is None and self.box is None:
            if self.center is None:
                return given
            if given is None:
                raise UsageError("--center needs --cylinder or --box")
            return replace(given, center=self._center())
        if self.cylinder is not None:
            diameter, height = (extent / MM for extent in self.cylinder)
            size = (diameter, diameter, height)
            return Workspace(WorkspaceShape.CYLINDER, size, self._center())
        assert self.box is not None
        x, y, z = (extent / MM for extent in self.box)
        return Workspace(WorkspaceShape.BOX, (x, y, z), self._center())

    def _center(self) -> tuple[float | None, float | None, float | None]:
        if self.center is None:
            return 0.0, 0.0, None
        found = []
        for word in self.center:
            try:
                found.append(None if word == "free" else float(word) / MM)
            except ValueError:
                raise UsageError(f"--center: a number or 'free' is needed, not {word!r}") from None
        x, y, z = found
        return x, y, z
