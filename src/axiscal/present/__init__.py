"""What people see of a campaign: plain figures, pictures of them, one page, and `result.json`."""
