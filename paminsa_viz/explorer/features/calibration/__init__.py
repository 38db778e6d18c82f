"""Calibration from measured poses."""
