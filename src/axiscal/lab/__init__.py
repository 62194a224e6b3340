"""Controls that are started here and driven without a screen, to be tried against machines with known errors."""
