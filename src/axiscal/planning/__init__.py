"""From what is known to the readings to come."""
