"""From requirements to a robot: where they hold, proven workspaces, and the search for lengths."""
