"""What machines of one type teach the next one: printers whose beds were measured, each left out in its turn."""
