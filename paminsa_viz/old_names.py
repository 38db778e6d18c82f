"""Words that have got another name: they may still stand in files, kept tabs and command lines.

Nothing that anybody has saved becomes unreadable, so they stay, here and as what kept states call
their parts (`explorer.core.tab_store`, `explorer.tabs`, `explorer.state.motion`).
"""

from __future__ import annotations

KNEES = {"printed": "lower", "mirror": "upper"}
"""Branches of the knee."""

FLAGS = {
    "--assembly": "--knee",
    "--minimum-time": "--shortest",
    "--jobs": "--workers",
    "--save": "--out",
}
"""Flags of the command line."""


def flags_of_today(words: list[str]) -> list[str]:
    """Return the words of a command line with flags, and values of the knee, as of today."""
    out: list[str] = []
    for word in words:
        flag, equals, value = word.partition("=")
        if flag in FLAGS:
            out.append(FLAGS[flag] + (equals and f"={KNEES.get(value, value)}"))
        elif out[-1:] == ["--knee"]:
            out.append(KNEES.get(word, word))
        else:
            out.append(word)
    return out
