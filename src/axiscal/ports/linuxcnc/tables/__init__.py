"""LinuxCNC: `COMP_FILE` tables of one axis, and HAL text that moves axes over others."""
