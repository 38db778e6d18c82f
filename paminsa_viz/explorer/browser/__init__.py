"""Everything that relies on a non-public name of viser, Plotly, uPlot or Mantine.

``page.js``, ``marks.js``, ``units.js``, ``number_fields.js``, ``tooltips.js``, ``names.js``,
``tour.js``, ``clipboard.js`` and the style sheets are the live page's, ``backdrop.js`` that of
every page with the robot, ``player.html`` and ``player.js`` that of a saved motion. What a release
has moved is reported once (`Bridge` on this side, the self-test of ``page.js`` on the other) and
costs one feature, not the page. The server's guard is the exception: where it does not fit, nothing
is served.
"""

from __future__ import annotations

import re
from importlib.resources import files


def asset(name: str, **replacements: str) -> str:
    """Return the text of one of this folder's files, with each ``@KEY@`` replaced."""
    text = files(__name__).joinpath(name).read_text(encoding="utf-8")
    return re.sub(r"@([A-Z]+)@", lambda found: replacements.get(found[1], found[0]), text)
