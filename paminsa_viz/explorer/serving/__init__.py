"""The guards around the web server: names, limits, messages, and the one seam to viser."""
