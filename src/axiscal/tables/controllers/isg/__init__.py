"""ISG kernel and Beckhoff TwinCAT CNC: volumetric compensation, and bilateral leadscrew tables."""

from axiscal.tables.controllers.isg.formats import read_csv, write_csv

__all__ = ["read_csv", "write_csv"]
