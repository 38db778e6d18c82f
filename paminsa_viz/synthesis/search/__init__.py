"""The search for lengths: cases, trial robots, the outer search, fronts."""
