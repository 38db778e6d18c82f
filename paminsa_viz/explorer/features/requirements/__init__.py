"""What a person asks for, and what fulfills it."""
