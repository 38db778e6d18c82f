"""Stiffness and vibration."""
