"""FANUC: stored pitch error compensation, in a file that the user's own control has punched."""
