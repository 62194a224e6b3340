"""What an outsider could have written: controls, printers, fleets, servers; each found by its name."""
