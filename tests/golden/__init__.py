"""Whole campaigns through the command line, and what people see of them in English and German.

`python -m tests.golden` plays the campaigns with the package that Python finds, and compares what they give with
`expected`; `--renew` writes `expected` anew. See README.md.
"""
