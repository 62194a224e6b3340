"""One module per control; they do not know each other."""
