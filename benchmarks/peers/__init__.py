"""Side by side with other libraries: the same problems, one common evaluator, every library in its own process."""
