"""What every feature stands on: the loop of a session, its frames, and actions on its document."""
