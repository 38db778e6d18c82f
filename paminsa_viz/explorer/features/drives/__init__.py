"""The search for drives."""
