"""Colors used everywhere: 3D scene, plots, tables and files show a leg in the same color.

The hues are from the Okabe-Ito set, which stays distinct for color-blind eyes.
"""

from __future__ import annotations

from dataclasses import dataclass, field

LEG_COLORS: tuple[str, str, str] = ("#0072B2", "#D55E00", "#009E73")
"""Legs 1, 2, 3 and their rotating actuators M1, M2, M3."""

LIFT_COLOR = "#7A5195"
"""Linear actuator M4, its arms and shafts, and the force F_4."""

ACTUATOR_COLORS: tuple[str, str, str, str] = (*LEG_COLORS, LIFT_COLOR)

INK = "#1f2933"
COORDINATE_COLORS: tuple[str, str, str, str] = ("#B5127E", "#857000", "#6B4F2A", INK)
"""Coordinates x, y, θ, z of the platform, so that none is taken for an actuator: none has the hue
of one, and x, y and z, which share a chart, differ in lightness as well."""

MUTED = "#7b8794"
PLATFORM = "#c9ced6"
REFERENCE = "#555555"
OK = "#2e8540"
WARN = "#e0a100"
BAD = "#c3362b"


def rgb(color: str) -> tuple[int, int, int]:
    """Return ``#rrggbb`` as three integers from 0 to 255."""
    return int(color[1:3], 16), int(color[3:5], 16), int(color[5:7], 16)


@dataclass(frozen=True)
class Theme:
    """Colors of what surrounds the data, on light or on dark ground.

    Attributes:
        dark: Whether the ground is dark.
        paper: The ground of figures.
        ink, soft_ink: Lines and letters, and letters of less weight.
        muted: Letters of even less weight; still 4.5 to 1 against the ground.
        faint: Grid lines.
        good, warn, bad: Letters that say how something is.
        good_fill, warn_fill, bad_fill: Areas and bars that say so.
        reference: The reference design.
        reachless, hatch: Cells of a map that cannot be reached, and the lines over them.
        backdrop: Top and bottom of the gradient behind the 3D view.
        changes: Data colors that the ground would swallow, and what is used in their place.
    """

    dark: bool
    paper: str
    ink: str
    soft_ink: str
    muted: str
    faint: str
    good: str
    warn: str
    bad: str
    good_fill: str
    warn_fill: str
    bad_fill: str
    reference: str
    reachless: str
    hatch: str
    backdrop: tuple[str, str]
    changes: dict[str, str] = field(default_factory=dict, hash=False)

    def shown(self, color: str) -> str:
        """Return how a color ``#rrggbb`` of the data is drawn on this ground."""
        return self.changes.get(color, color)


LIGHT = Theme(
    dark=False, paper="#ffffff", ink=INK, soft_ink="#3b4754", muted="#5b6772", faint="#e4e8ec",
    good="#1d6b2f", warn="#855c00", bad="#b02a20",
    good_fill=OK, warn_fill=WARN, bad_fill=BAD, reference=REFERENCE,
    reachless="#e2e5e9", hatch="#b9c0c8", backdrop=("#fcfdfe", "#d8dee5"),
)  # fmt: skip
"""The theme of figures for print, and of a page in daylight."""

DARK = Theme(
    dark=True, paper="#242424", ink="#e6e9ec", soft_ink="#c3cad1", muted="#a3acb5",
    faint="#3a4046", good="#6fce85", warn="#f0bd4a", bad="#ff8d80",
    good_fill="#3fa457", warn_fill="#e0a100", bad_fill="#e0574a", reference="#b4b9be",
    reachless="#34383d", hatch="#4d545c", backdrop=("#4a525c", "#23282e"),
    changes={
        "#0072B2": "#4fa8e0", "#D55E00": "#f08a3c", "#009E73": "#2fc398", "#7A5195": "#b892d4",
        "#B5127E": "#ff6fb5", "#857000": "#d9c33a", "#6B4F2A": "#caa07a",
        INK: "#e6e9ec", MUTED: "#a3acb5", REFERENCE: "#b4b9be", "#6b6b6b": "#a8a8a8",
        "#b5121b": "#ff8d80", "#000000": "#ffffff", BAD: "#ff7466",
    },
)  # fmt: skip
"""The theme of a page at night; its paper is that of viser's panels."""
