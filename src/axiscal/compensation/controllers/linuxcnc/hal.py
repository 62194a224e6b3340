"""What HAL makes of a text with a few components: a model of these, at rest, and of `setp`, `net` and `addf`.

Written from their manual pages (lincurve(9), sum2(9), mux2(9), limit2(9), mult2(9), halcmd(1)). It knows no other
component.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from axiscal.exceptions import TableError
from axiscal.numerics import Array

_COMPONENTS = ("lincurve", "sum2", "mux2", "limit2", "mult2")
_LIMITS = (("min", -1e20), ("max", 1e20))
"""By LinuxCNC's manual: what `limit2` has unless they are set."""
_ARROWS = {"=>", "<=", "<=>"}


@dataclass(slots=True)
class Hal:
    """A loaded HAL text: components by name, in the order in which they run, their settings, and the nets."""

    kinds: dict[str, tuple[str, int]] = field(default_factory=dict)
    order: list[str] = field(default_factory=list)
    settings: dict[str, float] = field(default_factory=dict)
    nets: dict[str, list[str]] = field(default_factory=dict)

    @classmethod
    def load(cls, text: str) -> Hal:
        """Return the loaded text; raises TableError for a line that it would refuse."""
        hal = cls()
        for number, line in enumerate(text.splitlines(), 1):
            words = line.split("#")[0].split()
            if words:
                hal._execute(words, number)
        return hal

    def run(self, given: Mapping[str, Array]) -> dict[str, Array]:
        """Return the value of every signal when all has come to rest, from pins outside.  given : pin -> (m,)."""
        pins, signals = dict(given), dict[str, Array]()
        self._spread(pins, signals)
        for name in self.order:
            pins[f"{name}.out"] = self._output(name, pins)
            self._spread(pins, signals)
        return signals

    def _execute(self, words: list[str], line: int) -> None:
        command, *rest = words
        if command == "loadrt" and rest[0] in _COMPONENTS:
            options = dict(word.split("=", 1) for word in rest[1:])
            names = options["names"].split(",")
            sizes = options.get("personality", ",".join("0" for _ in names)).split(",")
            self.kinds |= {n: (rest[0], int(s)) for n, s in zip(names, sizes, strict=True)}
        elif command == "addf" and rest[0] in self.kinds:
            self.order.append(rest[0])
        elif command == "setp" and rest[0].split(".")[0] in self.kinds:
            self.settings[rest[0]] = float(rest[1])
        elif command == "net":
            self.nets.setdefault(rest[0], []).extend(word for word in rest[1:] if word not in _ARROWS)
        else:
            raise TableError(f"line {line}: HAL does not know {' '.join(words)!r}", "this is a defect of axiscal")

    def _spread(self, pins: dict[str, Array], signals: dict[str, Array]) -> None:
        """Give the value of a pin that has one to its signal and to the other pins of it."""
        for signal, joined in self.nets.items():
            writers = [pin for pin in joined if pin.endswith((".out", "-cmd", "-homed"))]
            for writer in (pin for pin in writers if pin in pins):
                signals[signal] = pins[writer]
                pins |= {pin: pins[writer] for pin in joined if pin != writer}

    def _output(self, name: str, pins: Mapping[str, Array]) -> Array:
        kind, points = self.kinds[name]
        if kind == "lincurve":
            x, y = ([self._set(f"{name}.{axis}-val-{i:02d}") for i in range(points)] for axis in "xy")
            return np.interp(pins.get(f"{name}.in", np.zeros(1)), x, y)
        if kind == "limit2":
            low, high = (self._set(f"{name}.{end}", usual) for end, usual in _LIMITS)
            limited: Array = np.clip(pins.get(f"{name}.in", np.zeros(1)), low, high)
            return limited
        ins = [pins.get(f"{name}.in{i}", np.full(1, self._set(f"{name}.in{i}"))) for i in (0, 1)]
        if kind == "mux2":
            return np.where(pins.get(f"{name}.sel", np.zeros(1)) != 0, ins[1], ins[0])
        if kind == "mult2":
            product: Array = ins[0] * ins[1]
            return product
        gains = [self._set(f"{name}.gain{i}", 1.0) for i in (0, 1)]
        total: Array = gains[0] * ins[0] + gains[1] * ins[1] + self._set(f"{name}.offset")
        return total

    def _set(self, pin: str, usual: float = 0.0) -> float:
        return self.settings.get(pin, usual)
