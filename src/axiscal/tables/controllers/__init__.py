"""One module per controller, each with its own format written and read back; they do not know each other."""
