"""What a person says of one calibration: set-ups, target, and the readings that are at hand, checked."""
