"""Flags that several commands have: of a design, a pose, a region, files."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal, TypeAlias

import tyro

from paminsa_viz.cli.arguments import OrNone, UsageError, check_needs
from paminsa_viz.files.atomic import check_writable
from paminsa_viz.files.design_file import load_content, load_design
from paminsa_viz.files.tables import table_endings
from paminsa_viz.model.arrays import Pose
from paminsa_viz.model.design import APPENDIX_4, Design, Geometry, KneeBranch
from paminsa_viz.model.load import WRENCH, LoadFrame
from paminsa_viz.model.reach import home_pose
from paminsa_viz.plots.formats import figure_endings
from paminsa_viz.units import MM

if TYPE_CHECKING:
    from paminsa_viz.quantities.requirements import Requirements
    from paminsa_viz.studies.region import Region

NEEDS_FIGURE = f"--out with {', '.join(figure_endings()[:-1])} or {figure_endings()[-1]}"
"""What flags of figures need."""

Point: TypeAlias = tuple[float, float, float]
Wrench: TypeAlias = tuple[float, float, float, float, float, float]


def pose_si(pose: Pose) -> Pose:
    """Return a pose [mm, mm, degrees, mm] in [m, m, rad, m]."""
    x, y, theta, z = pose
    return x / MM, y / MM, math.radians(theta), z / MM


def check_output(flag: str, path: Path | None, endings: Iterable[str]) -> None:
    """Check, before anything is computed, that a file can be written if there is one.

    Its ending has to say what is written into it.

    Raises:
        UsageError: Which flag, and what endings there are.
        FileError: If there is no such folder, or something else is in the file's place.
    """
    if path is None:
        return
    endings = tuple(endings)
    if path.suffix.lower() not in endings:
        needed = "one of " if len(endings) > 1 else ""
        raise UsageError(f"{flag} {path}: its ending has to be {needed}{', '.join(endings)}")
    check_writable(path)


def check_range(flag: str, unit: str, ends: tuple[float, float]) -> None:
    """Check that two finite numbers are in order.

    Raises:
        UsageError: Which flag, and what its numbers are in.
    """
    low, high = ends
    if not (math.isfinite(low) and math.isfinite(high)):
        raise UsageError(f"{flag}: finite numbers of {unit} are needed, not {low:g} {high:g}")
    if not low <= high:
        raise UsageError(
            f"{flag} {low:g} {high:g}: the first number has to be at most the second [{unit}]"
        )


@dataclass(frozen=True, kw_only=True)
class DesignFlags:
    """The robot."""

    design: Annotated[OrNone[Path], tyro.conf.arg(metavar="FILE")] = None
    """Design file (TOML), instead of the paper's Appendix 4."""
    knee: OrNone[Literal["lower", "upper"]] = None
    """Branch of the knee 9: lower as Appendix 1 prints it, or upper, its mirror image; by default
    the design's own."""
    load: Annotated[OrNone[Wrench], tyro.conf.arg(metavar="FX FY FZ MX MY MZ")] = None
    """External force [N] and moment [N·m] on the platform, instead of the design's own. The
    actuators do not see MX and MY: the bearings carry them."""
    load_point: Annotated[OrNone[Point], tyro.conf.arg(metavar="X Y Z")] = None
    """Point of the force, from the platform's center and in the platform's frame [mm]; by default
    the design's own."""
    load_frame: OrNone[Literal["world", "platform"]] = None
    """What the directions of force and moment are fixed in; by default the design's own."""

    def given_design(self) -> Design:
        """Return the design.

        Raises:
            DesignFileError: If the file cannot be read or is refused.
        """
        design = APPENDIX_4 if self.design is None else load_design(self.design)
        changes: dict[str, Any] = dict(zip(WRENCH, self.load or (), strict=False))
        if self.load_point is not None:
            x, y, z = (value / MM for value in self.load_point)
            changes |= {"point_x": x, "point_y": y, "point_z": z}
        if self.load_frame is not None:
            changes["frame"] = LoadFrame(self.load_frame)
        if changes:
            design = replace(design, load=replace(design.load, **changes))
        return design if self.knee is None else design.with_knee(KneeBranch(self.knee))

    def given_requirements(self) -> Requirements | None:
        """Return what the robot is needed for; None if no file is given or it does not say.

        Raises:
            DesignFileError: If the file cannot be read or is refused.
        """
        return None if self.design is None else load_content(self.design).requirements


@dataclass(frozen=True, kw_only=True)
class ComparedDesignFlags(DesignFlags):
    """The robot and another one."""

    reference: Annotated[OrNone[Path], tyro.conf.arg(metavar="FILE")] = None
    """Another design file, to compare with on the same motion; maps show the design minus this
    one."""

    def given_reference(self, design: Design) -> Design | None:
        """Return the design to compare with, if one is given, with the same branch of the knee."""
        if self.reference is None:
            return None
        return load_design(self.reference).with_knee(design.geometry.knee)


@dataclass(frozen=True, kw_only=True)
class PoseFlags:
    """A pose of the platform."""

    pose: Annotated[OrNone[Pose], tyro.conf.arg(metavar="X Y THETA Z")] = None
    """Pose [mm, mm, °, mm]; in the middle of the workspace if left out."""

    def given_pose(self, geometry: Geometry) -> Pose:
        """Return the pose, or a robot's home pose [m, m, rad, m]."""
        return home_pose(geometry) if self.pose is None else pose_si(self.pose)


@dataclass(frozen=True, kw_only=True)
class RegionFlags:
    """Poses that numbers are over."""

    radius: Annotated[OrNone[float], tyro.conf.arg(metavar="MM")] = None
    """Radius of the disc of positions that numbers are over [mm]; half of R_b if left out."""
    theta: Annotated[tuple[float, ...], tyro.conf.arg(metavar="DEG")] = ()
    """An angle that they are over [°]; can be repeated. 0 and 30 if left out."""
    z: Annotated[tuple[float, ...], tyro.conf.arg(metavar="MM")] = ()
    """A height that they are over [mm]; can be repeated. In the middle of the workspace if left
    out."""
    cells: int = 40
    """Positions along the disc's diameter."""

    def given_region(self, design: Design) -> Region:
        """Return the region.

        Raises:
            UsageError, InvalidInput: If a number is not possible.
        """
        from paminsa_viz.studies.region import default_region  # late: few commands need it

        if self.radius is not None and not (math.isfinite(self.radius) and self.radius > 0):
            raise UsageError(f"--radius: a length above 0 mm is needed, not {self.radius:g}")
        region = default_region(design)
        return replace(
            region,
            radius=region.radius if self.radius is None else self.radius / MM,
            theta=tuple(math.radians(angle) for angle in self.theta) or region.theta,
            z=tuple(height / MM for height in self.z) or region.z,
            cells=self.cells,
        )


@dataclass(frozen=True, kw_only=True)
class JsonFlags:
    """Output for other programs."""

    json: bool = False
    """Print JSON for other programs, in SI units."""


@dataclass(frozen=True, kw_only=True)
class FilesFlags(JsonFlags):
    """Figures and tables."""

    out: Annotated[tuple[Path, ...], tyro.conf.arg(metavar="FILE")] = ()
    """File to write; its ending says what. Can be repeated; one that exists is replaced."""
    width: Annotated[float, tyro.conf.arg(metavar="MM")] = 170.0
    """Width of figures [mm]; 85 is a column, 170 a page."""
    dpi: float = 300.0
    """Pixels per inch of figures made of pixels."""

    def check_files(self, *others: str) -> None:
        """Refuse files of other formats than tables, figures and ``others``.

        Raises:
            UsageError: Which file, and what endings there are; or which flag needs a figure.
        """
        for path in self.out:
            check_output("--out", path, (*table_endings(), *figure_endings(), *others))
        check_needs(self, self.draws, NEEDS_FIGURE, "width", "dpi")

    @property
    def draws(self) -> bool:
        """Whether a figure is written."""
        return any(path.suffix.lower() in figure_endings() for path in self.out)
