"""How good any plan could be at the best, with a proof."""
