"""How a machine may deviate (ISO 230-1), how far beforehand, and what no reading can tell apart."""
