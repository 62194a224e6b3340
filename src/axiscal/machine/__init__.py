"""What the maker built: axes, the chain that joins them, and what is known beforehand about their errors."""

from axiscal.machine.axis import Axis
from axiscal.machine.description import ErrorEntry, Machine

__all__ = ["Axis", "ErrorEntry", "Machine"]
