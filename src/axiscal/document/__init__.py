"""A TOML document that knows its lines, so that every fault in it can be shown where it stands."""

from axiscal.document.file import Document
from axiscal.document.quoting import dotted, meant, quantity_text, shown
from axiscal.document.validation import Length, QuantityOf, QuantityText, read_model
from axiscal.units import nearest

__all__ = [
    "Document",
    "Length",
    "QuantityOf",
    "QuantityText",
    "dotted",
    "meant",
    "nearest",
    "quantity_text",
    "read_model",
    "shown",
]
