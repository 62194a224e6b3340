"""Certified answers: what must hold to the last digit, decided by ball arithmetic."""
