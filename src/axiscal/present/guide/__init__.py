"""What the person at the machine is shown and may answer: the question in words, what to expect, how far it is."""
