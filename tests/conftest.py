"""Loads what the tests share."""

pytest_plugins = ["tests.support.plugin", "tests.support.page"]
