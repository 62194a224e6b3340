"""What happened, event by event, and the file that never loses one."""
