"""The numbers of the design."""
