"""Name and version of the program, alone, so that any file can take them."""

__version__ = "0.1.0"

COMMAND = "paminsa-viz"
"""What is typed to run it."""

MADE_BY = f"paminsa_viz {__version__}"
"""What files, figures and answers say about who made them."""
