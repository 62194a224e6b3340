"""What an outsider could have written: controls and printers; each found by its name."""
