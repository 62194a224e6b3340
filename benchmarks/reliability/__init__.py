"""What was tried to lose something: `make reliability` prints its table, and tests run its short rows."""
