"""Machines that nobody drew: truths of numpy and hand-written rigid motion, told to the program by its command line."""
