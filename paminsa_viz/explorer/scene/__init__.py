"""The 3D view: nodes are made once, then posed, shown and hidden."""

from __future__ import annotations
