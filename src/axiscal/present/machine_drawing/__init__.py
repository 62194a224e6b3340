"""Machines drawn from their descriptions, with the instrument that stands on them."""
