"""From readings to what is known of a machine."""
