"""Machines and instruments that are not linear: how far, and what that brings. Writes docs/evidence/nonlinear.md."""
