"""The guards around the web server: names, limits, messages, and the one viser_patch to viser."""
