"""What to correct: tables made of the belief, tried in a simulated control before they are offered."""
