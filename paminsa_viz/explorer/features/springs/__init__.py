"""Springs next to the design."""
