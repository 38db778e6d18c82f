"""Balancing on the page: settings, tasks, their solution and their outcome."""
