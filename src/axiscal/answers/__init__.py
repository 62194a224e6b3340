"""What a job is told: its rows, with what was found and how well that is known, and the words for them."""
