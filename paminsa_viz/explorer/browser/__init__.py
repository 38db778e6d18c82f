"""Everything that relies on a non-public name of viser, Plotly, uPlot or Mantine.

``page.js``, ``marks.js``, ``units.js``, ``number_fields.js``, ``tooltips.js``, ``names.js``,
``tour.js``, ``clipboard.js`` and the style sheets are the live page's, with ``first_paint.js`` in
its head; ``backdrop.js`` is that of every page with the robot, ``player.html`` and ``player.js``
are those of a saved motion. What a release has moved is reported once (`Bridge` on this side, the
self-test of ``page.js`` on the other) and costs one feature, not the page. The server's guard is
the exception: where it does not fit, nothing is served.
"""

from __future__ import annotations

import re
from importlib.resources import files

STORE_KEY = "paminsa_viz"
"""What a tab's state is kept under in its own store."""


def asset(name: str, **replacements: str) -> str:
    """Return the text of one of this folder's files, with each ``@KEY@`` replaced."""
    text = files(__name__).joinpath(name).read_text(encoding="utf-8")
    return re.sub(r"@([A-Z]+)@", lambda found: replacements.get(found[1], found[0]), text)


def page_head() -> str:
    """Return what the head of the page needs to be dark at once, where it will be dark."""
    return f"<script>{asset('first_paint.js', STORE=STORE_KEY)}</script>"
