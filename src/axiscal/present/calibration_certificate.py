"""The Digital Calibration Certificate: a summary as XML after PTB's schema DCC 3.3.0 with D-SI 2.2.

Whoever has a key signs it (XAdES); a seal is for the laboratory to add. Facts that nobody said stand as "not stated".
An unknown country is ZZ, a code that ISO 3166-1 leaves to users.
"""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Sequence
from pathlib import Path

from axiscal.answers.answer import ResultAnswer
from axiscal.answers.digits import number
from axiscal.estimation.accuracy.expanded import BAND, LEVEL
from axiscal.exceptions import ReadingError
from axiscal.present.statement import in_space
from axiscal.present.summary import CurveSummary, SetupUse, Summary
from axiscal.record.signing import signed_xml

DCC, SI = "https://ptb.de/dcc", "https://ptb.de/si"
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
    ET.register_namespace("dcc", DCC)
    ET.register_namespace("si", SI)
    root = ET.Element(_dcc("digitalCalibrationCertificate"), schemaVersion=VERSION)
    _administration(root, summary)
    _results(_below(root, "measurementResults"), summary)
    ET.indent(root)
    document = ET.tostring(root, encoding="unicode").encode()
    return signed_xml(b'<?xml version="1.0" encoding="utf-8"?>\n' + document + b"\n", "Digital Calibration Certificate")


def check_against(schema: Path, document: bytes, file: Path) -> None:
    """Raise ReadingError where a certificate is not as a schema wants it.  schema : dcc.xsd, its imports beside it"""
    from lxml import etree

    try:
        checked = etree.XMLSchema(file=str(schema))
    except (etree.LxmlError, OSError) as failure:
        remedy = "Give PTB's dcc.xsd with what it imports in local files beside it"
        raise ReadingError(f"the schema cannot be used: {failure}", remedy, schema) from failure
    if not checked.validate(etree.fromstring(document)):
        fault = checked.error_log[0]
        what = f"{fault.path}: {fault.message}"
        raise ReadingError(what, f"This schema may be another version than DCC {VERSION}", file)


def _dcc(name: str) -> str:
    return f"{{{DCC}}}{name}"


def _si(name: str) -> str:
    return f"{{{SI}}}{name}"


def _below(parent: ET.Element, name: str, text: str | None = None) -> ET.Element:
    """Add an element of the certificate, with words or without."""
    child = ET.SubElement(parent, _dcc(name))
    child.text = None if text is None else _plain(text)
    return child


def _plain(text: str) -> str:
    """Return text as the schema takes it: words with one space between them, no sign that XML cannot hold."""
    kept = "".join(each if each.isprintable() else " " for each in text)
    return " ".join(kept.encode("utf-8", "replace").decode("utf-8").split()) or _UNSAID


def _words(parent: ET.Element, name: str, text: str) -> ET.Element:
    """Add an element that holds text in a language."""
    child = _below(parent, name)
    _below(child, "content", text).set("lang", "en")
    return child


def _administration(root: ET.Element, summary: Summary) -> None:
    data, said = _below(root, "administrativeData"), summary.particulars
    software = _below(_below(data, "dccSoftware"), "software")
    _words(software, "name", "axiscal")
    _below(software, "release", summary.versions.get("axiscal", "unknown"))
    _core(_below(data, "coreData"), summary)
    item = _below(_below(data, "items"), "item")
    _words(item, "name", summary.machine)
    if said.maker:
        _words(_below(item, "manufacturer"), "name", said.maker)
    _identified(item, "manufacturer", said.serial or _UNSAID, "serial number")
    contact = _below(_below(data, "calibrationLaboratory"), "contact")
    _contact(contact, said.laboratory, said.country, said.place)
    _persons(_below(data, "respPersons"), summary)
    _contact(_below(data, "customer"), said.customer, said.country, "")


def _core(core: ET.Element, summary: Summary) -> None:
    said = summary.particulars
    _below(core, "countryCodeISO3166_1", said.country.upper() or _UNKNOWN_COUNTRY)
    _below(core, "usedLangCodeISO639_1", "en")
    _below(core, "mandatoryLangCodeISO639_1", "en")
    _below(core, "uniqueIdentifier", _identifier(summary))
    _below(core, "beginPerformanceDate", summary.date)
    _below(core, "endPerformanceDate", summary.ended or summary.date)
    _below(core, "performanceLocation", "other")


def _identifier(summary: Summary) -> str:
    """Return the number of the report with the record's hash, or that alone: no other certificate has it."""
    known = "" if summary.record is None else summary.record.hash
    return " ".join(part for part in (summary.particulars.number, known) if part) or summary.title


def _identified(parent: ET.Element, issuer: str, value: str, name: str) -> None:
    one = _below(_below(parent, "identifications"), "identification")
    _below(one, "issuer", issuer)
    _below(one, "value", value)
    _words(one, "name", name)


def _contact(contact: ET.Element, name: str, country: str, place: str) -> None:
    _words(contact, "name", name or _UNSAID)
    location = _below(contact, "location")
    _below(location, "countryCode", country.upper() or _UNKNOWN_COUNTRY)
    if place:
        _words(location, "further", place)


def _persons(persons: ET.Element, summary: Summary) -> None:
    said = summary.particulars
    for role, name in (("responsible", said.responsible or _UNSAID), ("operator", said.operator)):
        if name:
            person = _below(persons, "respPerson")
            _words(_below(person, "person"), "name", name)
            _below(person, "role", role)
            _below(person, "mainSigner", str(role == "responsible").lower())


def _results(results: ET.Element, summary: Summary) -> None:
    method = _below(_below(results, "usedMethods"), "usedMethod")
    _words(method, "name", "Bayesian estimation of all component errors of the machine from readings of its tool point")
    for norm in ("ISO 230-1", *(["ISO 230-2"] if summary.iso230 else [])):
        _below(method, "norm", norm)
    if summary.setups:
        equipments = _below(results, "measuringEquipments")
        for use in summary.setups:
            _equipment(equipments, use)
    if summary.particulars.temperature:
        condition = _below(_below(results, "influenceConditions"), "influenceCondition")
        _words(condition, "name", "temperature")
        _words(_below(condition, "data"), "text", summary.particulars.temperature)
    result = _below(results, "measurementResult")
    _words(result, "name", summary.title)
    _words(result, "description", summary.agreement.words)
    _all(_below(result, "results"), summary)


def _equipment(equipments: ET.Element, use: SetupUse) -> None:
    one = _below(equipments, "measuringEquipment")
    _words(one, "name", f"{use.instrument}, {use.name}")
    if use.certificate:
        _words(one, "description", f"certificate {use.certificate}")
    _identified(one, "manufacturer", use.serial or _UNSAID, "serial number")


def _all(results: ET.Element, summary: Summary) -> None:
    """Add the rows, the tool point, every curve, every constant, ISO 230-2; uncertainties unless withheld."""
    _rows(results, summary.answer)
    if not summary.answer.withheld:
        found = summary.expanded
        data = _result(results, f"Expanded uncertainty of the tool point, {LEVEL:.0%}, {found.conditions}")
        listed = _below(data, "list")
        whole = "space" if found.along == "xyz" else in_space(found)
        for name, value in (*zip(["along x", "along y", "along z"], found.axes, strict=True), (whole, found.space)):
            _real(listed, name, value, "um")
    for curve in (*summary.curves, *summary.reversals):
        _curve(results, curve, summary.answer.withheld)
    own = [each for each in summary.constants if ": " not in each.name]
    if own:
        listed = _below(_result(results, "Location errors and constant reversals"), "list")
        for each in own:
            half = None if summary.answer.withheld else BAND * each.std
            _real(listed, f"{each.name}: {each.words}", each.mean, each.unit, half)
    for block in summary.iso230:
        listed = _below(_result(results, f"ISO 230-2, axis {block.axis}"), "list")
        for name, value in block.figures.items():
            _real(listed, name, value, block.value_unit, block.uncertainties.get(name), factor=2.0)


def _rows(results: ET.Element, answer: ResultAnswer) -> None:
    """Add what the answer says of each row that is measured."""
    rows = [row for row in answer.rows if row.measured]
    listed = _below(_result(results, "Answer, row by row: RMS as found and as left, U"), "list") if rows else results
    for row in rows:
        lefts = [(f"as left with {name}", size) for name, size in row.left.items()]
        for name, size in (("as found", row.found), (f"U, {LEVEL:.0%}", row.known_to), *lefts):
            _real(listed, f"{row.row}, {name}", size, row.unit)


def _result(results: ET.Element, name: str) -> ET.Element:
    result = _below(results, "result")
    _words(result, "name", name)
    return _below(result, "data")


def _curve(results: ET.Element, curve: CurveSummary, withheld: bool) -> None:
    listed = _below(_result(results, f"{curve.name}: {curve.caption}"), "list")
    _series(listed, f"position of {curve.axis}", curve.position, curve.position_unit)
    halves = None if withheld else [BAND * std for std in curve.std]
    _series(listed, curve.name, curve.mean, curve.value_unit, halves)


def _real(
    listed: ET.Element, name: str, value: float, unit: str, half: float | None = None, factor: float = BAND
) -> None:
    quantity = _below(listed, "quantity")
    _words(quantity, "name", name)
    real = ET.SubElement(quantity, _si("real"))
    ET.SubElement(real, _si("value")).text = _figure(value)
    ET.SubElement(real, _si("unit")).text = _plain(_UNITS.get(unit, unit))
    if half is not None:
        found = ET.SubElement(ET.SubElement(real, _si("measurementUncertaintyUnivariate")), _si("expandedMU"))
        ET.SubElement(found, _si("valueExpandedMU")).text = _figure(half)
        ET.SubElement(found, _si("coverageFactor")).text = _figure(factor)
        ET.SubElement(found, _si("coverageProbability")).text = _figure(LEVEL)


def _series(
    listed: ET.Element, name: str, values: Sequence[float], unit: str, halves: Sequence[float] | None = None
) -> None:
    quantity = _below(listed, "quantity")
    _words(quantity, "name", name)
    series = ET.SubElement(quantity, _si("realListXMLList"))
    ET.SubElement(series, _si("valueXMLList")).text = " ".join(map(_figure, values))
    ET.SubElement(series, _si("unitXMLList")).text = _plain(_UNITS.get(unit, unit))
    if halves is not None:
        uncertainty = ET.SubElement(series, _si("measurementUncertaintyUnivariateXMLList"))
        found = ET.SubElement(uncertainty, _si("expandedMUXMLList"))
        ET.SubElement(found, _si("valueExpandedMUXMLList")).text = " ".join(map(_figure, halves))
        ET.SubElement(found, _si("coverageFactorXMLList")).text = _figure(BAND)
        ET.SubElement(found, _si("coverageProbabilityXMLList")).text = _figure(LEVEL)


def _figure(value: float) -> str:
    return f"{number(value, 'a figure of the certificate'):.6g}"
