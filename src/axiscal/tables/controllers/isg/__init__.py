"""ISG kernel and Beckhoff TwinCAT CNC: volumetric compensation in two formats, and bilateral leadscrew tables."""

from axiscal.tables.controllers.isg.formats import read_csv, read_etalon, write_csv, write_etalon

__all__ = ["read_csv", "read_etalon", "write_csv", "write_etalon"]
