"""The door of the shop: devices on its network come in by TLS, each person's by a code that lets one in, once."""

from __future__ import annotations

import io
import os
import secrets
import socket
import ssl
from collections.abc import Sequence

import segno

from axiscal.answers.answer import AnswerDocument
from axiscal.exceptions import InputError
from axiscal.language.spoken import said
from axiscal.record.signing import own_hand, shop_certificate
from axiscal.web.guard import TOKEN_BYTES, Door, Tickets

LOOPBACK = "127.0.0.1"
_PORT = 8470
"""Of the shop unless said: a device finds what it keeps at the same address again. Any that nobody uses would do."""
CODE_LASTS = 600.0
"""s in which a code lets in: a person walks to the machine in that time."""
_ELSEWHERE = "192.0.2.1", 9
"""Nobody's address (RFC 5737): the way there begins on this computer's network, and nothing is sent."""


class Code(AnswerDocument):
    """A code for the device of a person: the address that it opens, its picture, and what the device shows first.

    rows : of squares, "1" for dark, without the margin; fingerprint : of the certificate
    """

    person: str
    address: str
    rows: Sequence[str]
    fingerprint: str


class Device(AnswerDocument):
    """What a device keeps: its bearer, and whose readings it takes."""

    bearer: str
    person: str


class ShopDoor:
    """What devices need to come in; raises InputError, RecordError, OSError.

    at : where it listens, address and port; without the address this computer's on its network
    address : of the page; fingerprint : of the certificate, which devices are shown
    """

    def __init__(self, at: str | None = None) -> None:
        host, _, port = (at or "").partition(":")
        if port and not port.isdecimal():
            raise InputError('"{text}" is no address', "Say an IPv4 address, a colon and a port", text=at)
        file, self.fingerprint = shop_certificate()
        self.context = ssl.create_default_context(ssl.Purpose.CLIENT_AUTH)
        try:
            self.context.load_cert_chain(file)
        except ssl.SSLError as fault:
            what, remedy = "The certificate {file} cannot be used: {reason}", "Remove it; another one is made"
            raise InputError(what, remedy, file=file, reason=fault.reason) from None
        self.listener = listening(host or _own_address(), int(port or _PORT))
        self._codes = Tickets[str](CODE_LASTS)
        here = "{}:{}".format(*self.listener.getsockname())
        self.address = f"https://{here}/"
        self.door = Door("https", (here,), {}, "Scan a code that axiscal serve --shop shows: it lets this device in")

    def code(self, person: str) -> Code:
        """Return a new code; raises InputError for a name that is none."""
        name = " ".join(person.split())
        if not name.isprintable() or not name:
            raise InputError(said("A code is for a person"), said("Name who measures with the device"))
        address = f"{self.address}#code={self._codes.issue(name)}"
        rows = ["".join(map(str, row)) for row in segno.make_qr(address, error="l").matrix]
        return Code(person=name, address=address, rows=rows, fingerprint=self.fingerprint)

    def invitation(self, people: Sequence[str]) -> str:
        """Return codes for a terminal, and what people compare.  people : this computer's user where they are none"""
        lines = list[str]()
        for code in map(self.code, people or [own_hand().person]):
            picture = io.StringIO()
            segno.make_qr(code.address, error="l").terminal(picture, compact=True)
            words = "{person}: scan it within 10 min, or open {address}"
            lines += [picture.getvalue(), said(words, person=code.person, address=code.address)]
        return "\n".join([*lines, said("SHA-256 of the certificate: {fingerprint}", fingerprint=self.fingerprint)])

    def let_in(self, code: str) -> Device:
        """Return what a device with a code gets; raises InputError for one that lets nobody in."""
        person = self._codes.redeem(code)
        if person is None:
            what, remedy = said("This code lets nobody in any more"), said("Scan a new one: each does once, for 10 min")
            raise InputError(what, remedy)
        bearer = secrets.token_urlsafe(TOKEN_BYTES)
        self.door.bearers[bearer] = person
        return Device(bearer=bearer, person=person)


def _own_address() -> str:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        try:
            probe.connect(_ELSEWHERE)
        except OSError as failure:
            what, remedy = "This computer is on no network: {reason}", "Connect it, or say its address with --at"
            raise InputError(what, remedy, reason=failure.strerror) from None
        return str(probe.getsockname()[0])


def listening(host: str, port: int) -> socket.socket:
    """Return what listens at an address; raises InputError where that cannot be."""
    listener = socket.socket(socket.AF_INET, socket.SOCK_STREAM)
    if os.name == "posix":  # connections of a server that was killed keep its port from the next one else
        listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
    try:
        listener.bind((host, port))
        listener.listen()
    except OSError as failure:
        listener.close()
        what, remedy = "Port {port} of {host} cannot be used: {reason}", "Name another one with {option}"
        option = "--port" if host == LOOPBACK else "--at ADDRESS:PORT"
        raise InputError(what, remedy, port=port, host=host, reason=failure.strerror, option=option) from failure
    return listener
