"""The best masses, counterweights and springs of a robot of given lengths."""
