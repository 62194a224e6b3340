"""The one place where the next reading brings most, exactly."""
