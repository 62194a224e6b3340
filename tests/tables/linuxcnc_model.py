"""What LinuxCNC makes of exported files: its `COMP_FILE`s with slopes of 32 bits, and HAL components at rest.

Written from their manual pages (lincurve(9), sum2(9), mux2(9), limit2(9), mult2(9), halcmd(1)) and from
compute_screw_comp of its source. It knows no other component.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from axiscal.machine import Machine
from axiscal.numerics import Array
from axiscal.ports.linuxcnc.tables.cross import Wiring
from axiscal.ports.linuxcnc.tables.writer import LinuxcncTable, parse
from axiscal.tables.surface import Control
from axiscal.units import from_unit, to_unit

_COMPONENTS = ("lincurve", "sum2", "mux2", "limit2", "mult2")
_LIMITS = (("min", -1e20), ("max", 1e20))
"""By LinuxCNC's manual: what `limit2` has unless they are set."""
_ARROWS = {"=>", "<=", "<=>"}
_HAL_FILE = "axiscal-cross.hal"


@dataclass(slots=True)
class Hal:
    """A loaded HAL text: components by name, in the order in which they run, their settings, and the nets."""

    kinds: dict[str, tuple[str, int]] = field(default_factory=dict)
    order: list[str] = field(default_factory=list)
    settings: dict[str, float] = field(default_factory=dict)
    nets: dict[str, list[str]] = field(default_factory=dict)

    @classmethod
    def load(cls, text: str) -> Hal:
        """Return the loaded text; raises ValueError for a line that it would refuse."""
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
            raise ValueError(f"line {line}: HAL does not know {' '.join(words)!r}")

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
            return np.clip(pins.get(f"{name}.in", np.zeros(1)), low, high)
        ins = [pins.get(f"{name}.in{i}", np.full(1, self._set(f"{name}.in{i}"))) for i in (0, 1)]
        if kind == "mux2":
            return np.where(pins.get(f"{name}.sel", np.zeros(1)) != 0, ins[1], ins[0])
        if kind == "mult2":
            return ins[0] * ins[1]
        gains = [self._set(f"{name}.gain{i}", 1.0) for i in (0, 1)]
        return gains[0] * ins[0] + gains[1] * ins[1] + self._set(f"{name}.offset")

    def _set(self, pin: str, usual: float = 0.0) -> float:
        return self.settings.get(pin, usual)


def correction(table: LinuxcncTable, position: Array, direction: int) -> Array:
    """Return what is added to the command at joint positions (m,), moving in direction +1 or -1, machine units."""
    trims = (table.forward if direction > 0 else table.reverse).astype(np.float32)
    if trims.size == 0:
        return np.zeros(np.shape(position))
    slopes = np.append((np.diff(trims) / np.diff(table.nominal)).astype(np.float32), np.float32(0))
    at = np.searchsorted(table.nominal, position, side="right") - 1
    within = np.maximum(at, 0)
    inside = trims[within] + slopes[within].astype(np.float64) * (position - table.nominal[within])
    return np.where(at < 0, np.float64(trims[0]), inside)


def control(machine: Machine, files: Mapping[str, str], wiring: Wiring) -> Control:
    """Return what LinuxCNC does with the files once all joints are homed."""
    own = {axis.name: parse(files[f"{axis.name}.comp"]) for axis in machine.axes if f"{axis.name}.comp" in files}
    hal = Hal.load(files.get(_HAL_FILE, ""))
    units = ["deg" if axis.rotary else wiring.unit for axis in machine.axes]

    def added(poses: Array, approaches: Array) -> Array:
        shown = np.stack([to_unit(column, u) for column, u in zip(poses.T, units, strict=True)], axis=1)
        motors = np.stack([_motor(own.get(a.name), shown[:, k], approaches[:, k]) for k, a in enumerate(machine.axes)])
        driven = _through(hal, machine, wiring, shown.T, motors)
        return np.stack([from_unit(t - s, u) for t, s, u in zip(driven, shown.T, units, strict=True)], axis=1)

    return added


def _motor(table: LinuxcncTable | None, shown: Array, approach: Array) -> Array:
    if table is None:
        return shown
    sides = [correction(table, shown, side) for side in (1, -1)]
    return shown + np.where(approach > 0, *sides)


def _through(hal: Hal, machine: Machine, wiring: Wiring, shown: Array, motors: Array) -> Array:
    """Return where the drives are sent, (q, m), after HAL has added its part."""
    given: dict[str, Array] = {"motion.is-all-homed": np.ones(1)}
    for k, axis in enumerate(machine.axes):
        for joint in wiring.joints[axis.name]:
            given |= {f"joint.{joint}.pos-cmd": shown[k], f"joint.{joint}.motor-pos-cmd": motors[k]}
    signals = hal.run(given)
    driven = np.empty_like(motors)
    for k, axis in enumerate(machine.axes):
        labels = wiring.labels(axis.name).values()
        each = np.stack([signals.get(f"axiscal-{label}-motor", motors[k]) for label in labels])
        assert np.all(each == each[0]), f"the joints of {axis.name} would not go together"
        driven[k] = each[0]
    return driven
