"""Figures, plain dicts, become SVG."""
