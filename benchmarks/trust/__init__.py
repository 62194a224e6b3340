"""Can you trust it? How often the printed band holds the truth, on virtual machines and on measured curves."""
