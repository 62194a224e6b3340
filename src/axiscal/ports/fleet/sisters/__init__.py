"""Errors that machines of one type share, and how they differ together: learnt from the readings of each of them."""
