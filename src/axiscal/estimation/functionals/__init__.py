"""The answer to what a job asks: rows with what was found, how well that is known, and what tables leave of it."""
