"""What the maker built: axes, the chain that joins them, and what is known beforehand about their errors."""

from axiscal.machine.description import DescribedMachine, builtin_names, load_machine, machine_from_text

__all__ = ["DescribedMachine", "builtin_names", "load_machine", "machine_from_text"]
