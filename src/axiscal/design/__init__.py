"""Where to measure next: candidates, criteria, the exact step, plans chosen together and their bounds."""
