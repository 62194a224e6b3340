"""Real controls beside the product: each is given what is exported for it, and what it does is compared with that.

`make controls`, or `python -m tests.controls --only NAME`, prints a row for each. Their sources lie in the folder that
AXISCAL_CONTROLS names, `../shared/controls` unless it says another; what is missing is skipped, and the row says why.
"""
