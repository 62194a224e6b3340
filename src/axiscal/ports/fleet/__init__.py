"""Many machines: what the records of one shop teach, and when a machine is due."""
