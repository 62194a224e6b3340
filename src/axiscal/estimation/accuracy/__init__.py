"""How good a belief is for the work: the yardstick of the volume, and the criterion that a plan makes small."""
