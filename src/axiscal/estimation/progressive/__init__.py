"""Estimates where the prior is so wide that the first linearisation misleads: by and by, then to the mode."""
