"""Machines and instruments that are not linear: how far, and what taking it off brings. Writes docs/nonlinear.md."""
