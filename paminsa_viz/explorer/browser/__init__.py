"""Everything that relies on a non-public name of viser, Plotly, uPlot or Mantine.

In the head of the live page are ``first_paint.js``, ``links.js``, ``reconnect.js``, ``context.js``,
``drawing.js``, ``inputs.js``, ``print.js`` and ``number_fields.js``; ``page.js``, the other scripts
and the style sheets follow with its first messages. ``backdrop.js`` is that of every page with the
robot, ``narrow.js`` that of every saved one; ``player.html`` and ``player.js`` are those of a saved
motion. What a release has moved is reported once (`Bridge` on this side, ``self_test.js`` on the
other) and costs one feature, not the page. The server's guard is the exception: where it does not
fit, nothing is served.
"""

from __future__ import annotations

import json
import re
from importlib.resources import files

from paminsa_viz.palette import DARK, LIGHT, rgb
from paminsa_viz.units import TYPED_UNITS

TITLE = "PAMINSA explorer"
"""The page's title, which the design's name is put before."""

STORE_KEY = "paminsa_viz"
"""What a tab's state is kept under in its own store."""

SOFTWARE_RENDERERS = ("swiftshader", "llvmpipe", "softpipe", "software", "basic render")
"""Parts of the names of what draws in the absence of a graphics card."""

LONGEST_LINK = 16_000
"""Most characters that are read of an address after its ``#``."""


def asset(name: str, **replacements: str) -> str:
    """Return the text of one of this folder's files, with each ``@KEY@`` replaced."""
    text = files(__name__).joinpath(name).read_text(encoding="utf-8")
    return re.sub(r"@([A-Z]+)@", lambda found: replacements.get(found[1], found[0]), text)


def _backdrops() -> str:
    """Return the top and the bottom of both themes' backdrops, as JSON of shares of one."""
    themes = {"light": LIGHT, "dark": DARK}
    return json.dumps(
        {
            name: [[round(part / 255, 4) for part in rgb(color)] for color in theme.backdrop]
            for name, theme in themes.items()
        }
    )


def page_head() -> str:
    """Return what the head of the page holds: its title, and scripts that may not come late."""
    scripts = (
        asset("first_paint.js", STORE=STORE_KEY),
        asset("links.js", STORE=STORE_KEY, LONGEST=str(LONGEST_LINK + 1)),
        asset("reconnect.js"),
        asset("context.js"),
        asset("drawing.js", PROGRAMS="|".join(SOFTWARE_RENDERERS), BACKDROPS=_backdrops()),
        asset("inputs.js"),
        asset("print.js"),
        asset("number_fields.js", KINDS=json.dumps(TYPED_UNITS)),
    )
    return f"<title>{TITLE}</title>" + "".join(f"<script>{script}</script>" for script in scripts)
