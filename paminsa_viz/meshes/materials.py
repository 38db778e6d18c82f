"""Surfaces of the robot: a few physically based materials, named so that parts can recolor."""

from __future__ import annotations

from dataclasses import dataclass

from trimesh.visual.material import PBRMaterial

from paminsa_viz import palette

ACCENT = "accent"
"""Material of a part's colored faces; each leg and M4 put their own color in its place."""


@dataclass(frozen=True)
class Surface:
    """A color (``#rrggbb``, as seen) with the two numbers of the metal-rough model, 0 to 1.

    A surface that is not ``lit`` shows its color as it is; it is the cheapest to draw.
    """

    color: str
    metallic: float
    roughness: float
    lit: bool = True


SURFACES: dict[str, Surface] = {
    "frame": Surface("#b7bfc8", 0.1, 0.48),
    "body": Surface("#3b434c", 0.15, 0.5),
    "dark": Surface("#20252b", 0.1, 0.6),
    "steel": Surface("#c3c9d0", 0.25, 0.32),
    "platform": Surface(palette.PLATFORM, 0.1, 0.42),
    "floor": Surface("#edf1f6", 0.0, 0.85, lit=False),
    "rim": Surface("#bcc4ce", 0.0, 0.85, lit=False),
    "line": Surface("#d3d9e0", 0.0, 0.85, lit=False),
    "load": Surface("#c39a4c", 0.2, 0.4),
    ACCENT: Surface("#8a929b", 0.1, 0.42),
}
"""Every material that a part may carry, by name."""

COMMON = Surface("#ffffff", 0.12, 0.46)
"""What stands for all lit surfaces where each point has its own color."""


def srgb_to_linear(color: str) -> tuple[float, float, float]:
    """Return ``#rrggbb`` as linear light, 0 to 1: what glTF wants in a base color factor."""
    levels = (channel / 255 for channel in palette.rgb(color))
    red, green, blue = (
        level / 12.92 if level <= 0.04045 else ((level + 0.055) / 1.055) ** 2.4 for level in levels
    )
    return red, green, blue


def color_of_surface(name: str, accent: str | None) -> str:
    """Return a surface's color; ``accent`` (``#rrggbb``) replaces that of `ACCENT`.

    Raises:
        KeyError: If there is no such surface.
    """
    return accent if name == ACCENT and accent else SURFACES[name].color


def material(name: str, surface: Surface, color: str) -> PBRMaterial:
    """Return a surface in a color (``#rrggbb``) as trimesh writes it into glTF."""
    return PBRMaterial(
        name=name,
        baseColorFactor=[round(v, 4) for v in srgb_to_linear(color)] + [1.0],
        metallicFactor=surface.metallic,
        roughnessFactor=surface.roughness,
    )
