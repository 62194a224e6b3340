"""The language of people: English sentences in the code, other languages from one file each."""
