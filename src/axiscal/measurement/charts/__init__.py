"""Charts u -> pose: where a set-up can be read. What a chart does not give is not asked for."""
