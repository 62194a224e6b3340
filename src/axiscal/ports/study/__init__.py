"""Studies: thousands of virtual machines, measured in ways that are compared, on one computer or on many."""
