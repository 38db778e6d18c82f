"""Loads what the tests share."""

pytest_plugins = ["pytester", "tests.support.page", "tests.support.plugin"]
