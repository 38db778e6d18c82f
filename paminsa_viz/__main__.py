"""``python -m paminsa_viz``: the same as the command ``paminsa-viz``."""

from __future__ import annotations

import sys

from paminsa_viz.cli import main

if __name__ == "__main__":
    sys.exit(main())
