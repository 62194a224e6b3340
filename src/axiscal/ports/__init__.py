"""What an outsider could have written: controls, printers, fleets, studies, servers; each found by its name."""
