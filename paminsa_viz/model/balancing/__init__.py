"""Optimal redistribution of masses: counterweights, springs, fronts, sensitivities, search."""

from __future__ import annotations
