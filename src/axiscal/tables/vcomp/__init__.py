"""A file of every error of a machine, for controls that take all of them away at once: written, read, and applied."""
