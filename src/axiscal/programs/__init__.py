"""Measuring programs: the planned readings as a program that the machine's own control runs."""

from __future__ import annotations

from axiscal.programs.dialects import controllers, dialect
from axiscal.programs.program import Program, programs, write_programs

__all__ = ["Program", "controllers", "dialect", "programs", "write_programs"]
