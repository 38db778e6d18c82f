"""Files of what the page shows."""
