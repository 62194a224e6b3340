"""Siemens SINUMERIK: `$AA_ENC_COMP` for an axis over itself, `$AN_CEC` for directions and sag."""

from axiscal.tables.controllers.sinumerik.read_back import read
from axiscal.tables.controllers.sinumerik.writing import blocks_of, write

__all__ = ["blocks_of", "read", "write"]
