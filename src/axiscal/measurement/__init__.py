"""What an instrument sees of a machine: instruments, set-ups, readings, and the rows of the linear map."""
