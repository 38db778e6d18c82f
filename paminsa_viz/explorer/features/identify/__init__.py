"""Identification from logs."""
