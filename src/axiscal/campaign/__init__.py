"""The record of a campaign: what was asked, read and decided, and the closed loop over it."""
