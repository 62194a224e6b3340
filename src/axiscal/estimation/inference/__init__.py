"""What the readings say about the priors themselves: scales by marginal likelihood, and readings that do not fit."""
