"""Clearance of the bodies."""
