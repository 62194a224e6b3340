"""Whole campaigns through the command line, and what people see of them, so that two versions can be compared.

`python -m tests.scenarios --out DIR` plays the campaigns with the sources that PYTHONPATH names and writes what they
gave; `python -m tests.scenarios --compare DIR_A DIR_B` says what differs. Nothing here imports the package.
"""
