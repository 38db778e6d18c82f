"""Accuracy: errors of the drives, unequal legs, tolerances and clearances, calibration."""
