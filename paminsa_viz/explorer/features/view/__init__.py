"""Theme, cameras, layers."""
