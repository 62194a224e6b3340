"""Measuring programs: the planned readings as a program that the machine's own control runs."""

from __future__ import annotations

from axiscal.gcode.options import Options
from axiscal.gcode.program import Program, Visit, programs
from axiscal.gcode.registry import controllers, dialect
from axiscal.gcode.writing import write_programs

__all__ = ["Options", "Program", "Visit", "controllers", "dialect", "programs", "write_programs"]
