"""The Digital Calibration Certificate: a summary as XML after PTB's schema DCC 3.3.0 with D-SI 2.2.

Whoever has a key signs it (XAdES); a seal is for the laboratory to add. Facts that nobody said stand as "not stated".
An unknown country is ZZ, a code that ISO 3166-1 leaves to users. Its elements stand in `templates/certificate.xml`.
"""

from __future__ import annotations

from axiscal.answers.digits import number
from axiscal.estimation.accuracy.expanded import BAND, LEVEL
from axiscal.present.standalone import environment
from axiscal.present.statement import in_space
from axiscal.present.summary import Summary
from axiscal.record.signing import signed_xml

VERSION = "3.3.0"
_UNITS = {
    "um": r"\micro\metre",
    "mm": r"\milli\metre",
    "urad": r"\micro\radian",
    "deg": r"\degree",
    "arcsec": r"\arcsecond",
}
_UNSAID = "not stated"
_UNKNOWN_COUNTRY = "ZZ"


def certificate(summary: Summary) -> bytes:
    """Return the certificate as XML; raises SummaryError for a figure that is not finite, RecordError for a bad key."""
    templates, told = environment("axiscal.present"), summary.particulars
    templates.filters |= {
        "plain": _plain,
        "si": lambda unit: _plain(_UNITS.get(str(unit), str(unit))),
        "figure": lambda value: f"{number(value, 'a figure of the certificate'):.6g}",
        "half": lambda std: BAND * std,
    }
    templates.globals |= {"unsaid": _UNSAID, "band": BAND, "level": LEVEL, "level_percent": f"{LEVEL:.0%}", "zip": zip}
    known = "" if summary.record is None else summary.record.hash
    text = templates.get_template("certificate.xml").render(
        s=summary,
        told=told,
        country=told.country.upper() or _UNKNOWN_COUNTRY,
        identifier=" ".join(part for part in (summary.particulars.number, known) if part) or summary.title,
        measured=[row for row in summary.answer.rows if row.measured],
        whole="space" if summary.expanded.along == "xyz" else in_space(summary.expanded),
        curves=[*summary.curves, *summary.reversals],
        constants=[each for each in summary.constants if ": " not in each.name],
    )
    document = "".join(f"{line}\n" for line in text.splitlines() if line).encode()
    return signed_xml(document, "Digital Calibration Certificate")


def _plain(text: str) -> str:
    """Return text as the schema takes it: words with one space between them, no sign that XML cannot hold."""
    kept = "".join(each if each.isprintable() else " " for each in text)
    return " ".join(kept.encode("utf-8", "replace").decode("utf-8").split()) or _UNSAID
