"""A balance within tolerances."""
