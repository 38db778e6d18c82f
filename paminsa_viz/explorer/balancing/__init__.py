"""Balancing on the page: what is asked for, how it is worked out, what comes of it."""
