"""What machines of one type share, and how they differ together: learnt from what was read on each of them."""
