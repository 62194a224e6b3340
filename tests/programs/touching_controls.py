"""A small control that runs programs that touch spheres and write logs. The machine is that of `touched_table`."""

import re
from collections.abc import Mapping

import numpy as np

from tests.generators import touched_table as table


class TouchingMachine:
    """The axes of the machine, in mm and deg, and the log; they begin where nothing is near.

    noise : of what it logs of an axis, mm
    """

    def __init__(self, noise: float = 0.0) -> None:
        self._noise, self._rng = noise, np.random.default_rng(3)
        self.at = {"X": 0.0, "Y": 0.0, "Z": 200.0, "A": 0.0, "C": 0.0}
        self.log = list[str]()
        self.touches = 0

    def move(self, to: Mapping[str, float]) -> None:
        """Go straight; raises AssertionError where something is met."""
        there = self.at | dict(to)
        turning = any(there[axis] != self.at[axis] for axis in "AC")
        assert turning or table.met(self.at, there) is None, f"ran into a sphere on the way to {to}"
        self.at = there

    def stood(self, axis: str) -> float:
        """Return where it says that an axis stands, mm."""
        return self.at[axis] + float(self._rng.normal(0, self._noise))

    def probe(self, to: Mapping[str, float]) -> bool:
        """Go straight until something is met, and return whether it was."""
        self.touches += 1
        hit = table.met(self.at, self.at | dict(to))
        self.at = self.at | dict(to) if hit is None else hit
        return hit is not None


def run_linuxcnc(text: str, machine: TouchingMachine) -> list[str]:
    """Run a program on LinuxCNC: its routine touches fast, goes a step back, touches slowly, and goes off again."""
    body, _, main = text.partition("O<axiscal_touch> SUB")[2].partition("O<axiscal_touch> ENDSUB")
    assert body.count("G38.3 X#3 Y#4 Z#5") == 2
    for line in main.splitlines():
        if found := re.fullmatch(r"O<axiscal_touch> CALL (.*)", line):
            numbers = [float(each) for each in re.findall(r"\[(.*?)\]", found[1])]
            into, back, beside = (dict(zip("XYZ", numbers[k : k + 3], strict=True)) for k in (2, 5, 8))
            assert len(numbers) == 14
            for step in (back, None):
                if not machine.probe(into):
                    machine.log.append(f"MISS R{numbers[0]:f} T{numbers[1]:f}")
                    return machine.log
                machine.move({} if step is None else {axis: machine.at[axis] + by for axis, by in step.items()})
            stood = " ".join(f"{axis}{machine.stood(axis):f}" for axis in "XYZ")
            machine.log.append(f"R{numbers[0]:f} T{numbers[1]:f} {stood}")
            machine.move(beside)
        elif found := re.fullmatch(r"G53 G1 (.*) F\d+", line):
            machine.move({word[0]: float(word[1:]) for word in found[1].split()})
        elif found := re.fullmatch(r"\(LOG,(.*)\)", line):
            machine.log.append(found[1])
    return machine.log
