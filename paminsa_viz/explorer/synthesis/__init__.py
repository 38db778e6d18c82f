"""Synthesis on the page: what is searched, the search, and what came of it."""
