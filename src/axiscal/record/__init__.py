"""The events of a campaign, one by one, and the file that never loses one."""
