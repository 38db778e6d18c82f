"""Panels of the page; each builds its inputs once and then draws what changed."""
