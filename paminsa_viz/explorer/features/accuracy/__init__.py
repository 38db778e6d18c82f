"""Errors of the platform, of drives and of manufacture."""
