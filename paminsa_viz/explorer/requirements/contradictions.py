"""Requirements that contradict, and the nearest bounds that would do, as text."""

from __future__ import annotations

from paminsa_viz.quantities.requirement_text import requirement_label
from paminsa_viz.quantities.requirements import Workspace
from paminsa_viz.synthesis.volume.conflict import smallest_conflict
from paminsa_viz.synthesis.volume.solve import Volume


def conflict_text(volume: Volume, workspace: Workspace | None) -> str:
    """Return the fewest requirements that leave nothing, and the nearest bounds that would.

    Nothing if there is something, such as a place for a workspace.
    """
    conflict = smallest_conflict(volume, workspace)
    if conflict is None:
        return ""
    what = "volume is empty" if workspace is None else "workspace does not fit"
    if not conflict.requirements:
        return f"The {what}: its poses cannot be reached with every heading."
    bounds = volume.requirements.bounds
    labels = " and ".join(requirement_label(bounds[i]) for i in conflict.requirements)
    verb = "hold nowhere together" if len(conflict.requirements) > 1 else "holds nowhere"
    helps = [
        requirement_label(each.relaxed) for each in conflict.relaxations if each.relaxed is not None
    ]
    nearest = f" Nearest bound that would do: {' or '.join(helps)}." if helps else ""
    return f"The {what}: {labels} {verb}.{nearest}"
