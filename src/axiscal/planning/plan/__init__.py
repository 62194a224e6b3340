"""Many readings chosen together, in order and within limits."""
