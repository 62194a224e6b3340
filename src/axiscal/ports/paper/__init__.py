"""The paper's simulations again: its splines, its stacked machine, its figures, with the program's own parts."""
