"""What a reading brings: the formula, and the fast ways to it."""
