"""What people who write Python use: curves, plans and estimates in a few lines, with pictures and tables."""
