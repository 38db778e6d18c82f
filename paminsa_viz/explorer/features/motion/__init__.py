"""The motion: its description, plan, curves and simulation."""
