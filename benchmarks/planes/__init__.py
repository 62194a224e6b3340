"""Measured maps, read in few places: what errors of two axes buy, and what planning them buys."""
