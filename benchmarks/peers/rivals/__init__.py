"""One small adapter per library, loaded only in that library's own environment.

Each has `picker(posed)`, which returns what finds the next position from those taken so far, or `planner(posed)`, which
returns what finds all positions together. Preparation that a user does once is not timed; what they return is.
"""
