"""Measurements, run by command; the README of this folder lists them."""
