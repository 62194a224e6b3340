"""Studies: thousands of virtual machines, measured in ways that are compared."""
