"""The guard around the web server: names, limits, messages, and the one patch to viser."""
