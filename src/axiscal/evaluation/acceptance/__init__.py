"""Whether a compensated machine is as good as its tables promise."""
