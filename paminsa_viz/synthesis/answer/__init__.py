"""What an answer is worth: its margins as built and by MuJoCo, and what requirements cost."""
