"""LinuxCNC: its tables, its component, and a control that is started here or runs at its owner's."""
