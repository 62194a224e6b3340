"""LinuxCNC: its tables, its component, and a control that runs at its owner's."""
