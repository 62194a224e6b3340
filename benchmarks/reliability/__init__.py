"""What is tried against axiscal on purpose: faults, kills, lost power, changed bits, bad files, many writers.

`make reliability` runs all of it and prints one table; the tests run its short rows.
"""
