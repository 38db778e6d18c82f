"""The static balance, masses and counterweights."""
