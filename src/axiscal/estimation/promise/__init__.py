"""One model of what usually goes wrong, one posterior, one U."""
