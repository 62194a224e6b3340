"""Small controls that run programs that touch spheres and write logs, each by the descriptions of its maker.

They know the few blocks that such a program may have and refuse every other. The machine is that of `touched_table`.
"""

from __future__ import annotations

import re
from collections.abc import Mapping

from tests.generators import touched_table as table

_NUMBER = r"[+-]?\d+\.\d+"


class TouchingMachine:
    """The axes of the machine, in mm and deg, and the log; they begin where nothing is near."""

    def __init__(self) -> None:
        self.at = {"X": 0.0, "Y": 0.0, "Z": 200.0, "A": 0.0, "C": 0.0}
        self.log = list[str]()
        self.touches = 0

    def move(self, to: Mapping[str, float]) -> None:
        """Go straight; raises AssertionError where something is met."""
        there = self.at | dict(to)
        turning = any(there[axis] != self.at[axis] for axis in "AC")
        assert turning or table.met(self.at, there) is None, f"ran into a sphere on the way to {to}"
        self.at = there

    def probe(self, to: Mapping[str, float]) -> bool:
        """Go straight until something is met, and return whether it was."""
        self.touches += 1
        hit = table.met(self.at, self.at | dict(to))
        self.at = self.at | dict(to) if hit is None else hit
        return hit is not None


def _words(text: str) -> dict[str, float]:
    pairs = [re.fullmatch(rf"([XYZAC])({_NUMBER})", word) for word in text.split()]
    assert pairs
    assert all(pairs), text
    return {pair[1]: float(pair[2]) for pair in pairs if pair}


def run_fanuc(text: str, beside: Mapping[str, str], machine: TouchingMachine) -> list[str]:
    """G31 ends at the skip; DPRNT sends [54] as blanks, sign, digits, a point and four decimals."""
    lines, at, skipped, opened, incremental = text.splitlines(), 0, dict[str, float](), False, False
    while lines[at] != "M30":
        line = lines[at]
        at += 1
        incremental = incremental and not line.startswith("G90")
        if line.startswith("G91 G1 "):
            steps = _words(line.removeprefix("G91 G1 ").rpartition(" F")[0])
            machine.move({axis: machine.at[axis] + step for axis, step in steps.items()})
            incremental = True
        elif found := re.fullmatch(r"(?:G90 )?G31 (.*) F(\d+)", line):
            assert not incremental, "an absolute place in incremental mode"
            machine.probe(_words(found[1]))
            skipped = {axis: machine.at[axis] for axis in "XYZ"}
        elif found := re.fullmatch(rf"IF\[(ABS.*#5061.*)LT({_NUMBER})\]GOTO(\d+)", line):
            ends = re.findall(rf"ABS\[#(506[123])-\[({_NUMBER})\]\]", found[1])
            apart = sum(abs(skipped["XYZ"[int(number) - 5061]] - float(end)) for number, end in ends)
            assert len(ends) == 3
            at = lines.index(f"N{found[3]} PCLOS") if apart < float(found[2]) else at
        elif line.startswith("G1 "):
            assert not incremental
            machine.move(_words(line.removeprefix("G1 ").rpartition(" F")[0]))
        elif line in ("POPEN", "PCLOS", "N9001 PCLOS"):
            opened = line == "POPEN"
        elif found := re.fullmatch(r"DPRNT\[(.*)\]", line):
            assert opened
            values = {f"#{5061 + k}[54]": f"{skipped.get(axis, 0):10.4f}" for k, axis in enumerate("XYZ")}
            sent = found[1].replace("*", " ")
            for name, value in values.items():
                sent = sent.replace(name, value)
            assert re.fullmatch(r"[A-Z0-9 .+-]*", sent)
            machine.log.append(sent + "\r")
        elif found := re.fullmatch(r"GOTO(\d+)", line):
            at = lines.index(f"N{found[1]}")
        elif line.startswith("#3000"):
            break
        else:
            head = r"%|O\d+|G21 .*|G15|G50|G50\.1 .*|G69|M5|M9|G54|G61"
            known = head + r"|G64|M0|\(.*\)|G4 P\d+|IF\[#4008.*|IF\[ABS\[#502.*|N9002"
            assert re.fullmatch(known, line), line
    return machine.log


def run_sinumerik(text: str, beside: Mapping[str, str], machine: TouchingMachine) -> list[str]:
    """MEAS stores what the axes of its block were at; STOPRE before it is read; << writes as few digits as it needs."""
    lines, at, measured, switched, stopped, incremental = text.splitlines(), 0, dict[str, float](), 0, False, False
    assert lines[0] == "DEF INT AXERR", "definitions come first"
    while lines[at] != "M30":
        line = lines[at]
        at += 1
        if line.startswith("G91 G1 "):
            steps = _words(line.removeprefix("G91 G1 ").rpartition(" F")[0])
            machine.move({axis: machine.at[axis] + step for axis, step in steps.items()})
            incremental = True
        elif found := re.fullmatch(r"(G90 )?MEAS=1 G1 SUPA (.*) F(\d+)", line):
            incremental = incremental and found[1] is None
            assert not incremental
            to = _words(found[2])
            assert set(to) == set("XYZ"), "only the axes of the block are measured"
            switched, stopped = int(machine.probe(to)), False
            measured = {axis: machine.at[axis] for axis in to}
        elif line == "STOPRE":
            stopped = True
        elif found := re.fullmatch(r"IF \$AC_MEA\[1\]==0 GOTOF (\w+)", line):
            assert stopped
            at = at if switched else next(k for k, each in enumerate(lines) if each.startswith(f"{found[1]}:"))
        elif found := re.fullmatch(r'WRITE\(AXERR,"_N_\w+_MPF",(.*)\)', line):
            parts = []
            for part in found[1].split("<<"):
                name = re.fullmatch(r"\$AA_MM\[([XYZ])\]", part)
                assert stopped or name is None
                parts.append(f"{measured[name[1]]:.6f}".rstrip("0").rstrip(".") if name else part.strip('"'))
            machine.log.append("".join(parts))
        elif found := re.fullmatch(r"GOTOF (\w+)", line):
            at = next(k for k, each in enumerate(lines) if each.startswith(f"{found[1]}:"))
        elif line.startswith("G1 SUPA "):
            assert not incremental
            machine.move(_words(line.removeprefix("G1 SUPA ").rpartition(" F")[0]))
        else:
            known = (
                r"DEF INT AXERR|TRAFOOF|DIAMOF|TRANS|G710 .*|M5 M9|FGROUP\(.*\)|M0|; .*|G4 F.*|IF AXERR<>0 GOTOF AXFULL"
            )
            known += r"|(\w+: )?MSG\(.*\)"
            assert re.fullmatch(known, line), line
    return machine.log


def run_heidenhain(text: str, beside: Mapping[str, str], machine: TouchingMachine) -> list[str]:
    """Cycle 4 measures along a vector in REF and draws back by MB; FN 16 prints a mask, M_APPEND at its end."""
    lines, at, q = [line.partition(" ")[2] for line in text.splitlines()], 0, dict[str, float]()
    vector, first = dict[str, float](), ""
    while lines[at] != "M30":
        line = lines[at]
        at += 1
        if found := re.fullmatch(r"TCH PROBE 4\.1 Q(\d+)", line):
            first = found[1]
            assert lines[at - 2] == "TCH PROBE 4.0 MEASURING IN 3-D"
        elif found := re.fullmatch(rf"TCH PROBE 4\.2 IX({_NUMBER}) IY({_NUMBER}) IZ({_NUMBER})", line):
            vector = dict(zip("XYZ", map(float, found.groups()), strict=True))
        elif found := re.fullmatch(
            rf"TCH PROBE 4\.3 DIST({_NUMBER}) F(\d+) MB({_NUMBER}) REFERENCE SYSTEM: ([01])", line
        ):
            assert found[4] == "1", "in the machine's own system"
            hit = machine.probe({axis: machine.at[axis] + float(found[1]) * along for axis, along in vector.items()})
            results = [machine.at[axis] for axis in "XYZ"]
            q |= {f"Q{int(first) + k}": value for k, value in enumerate([*results, 1.0 if hit else -1.0])}
            if hit:
                machine.move({axis: machine.at[axis] - float(found[3]) * along for axis, along in vector.items()})
        elif found := re.fullmatch(r"FN 9: IF \+(\w+) EQU ([+-]\d+) GOTO LBL (\d+)", line):
            left = q[found[1]] if found[1].startswith("Q") else float(found[1])
            at = lines.index(f"LBL {found[3]}") if left == float(found[2]) else at
        elif found := re.fullmatch(r"FN 0: (Q\d+) = \+(\d+)", line):
            q[found[1]] = float(found[2])
        elif found := re.fullmatch(r"FN 16: F-PRINT TNC:\\AXISCAL\\(\w+\.A) / TNC:\\AXISCAL\\\w+\.TXT", line):
            shown, append = beside[found[1]].splitlines()
            assert append == "M_APPEND;"
            mask = re.fullmatch(r'"([^"]*)"((?:,Q\d+)*);', shown)
            assert mask
            given = [q[name] for name in mask[2].split(",") if name]
            machine.log.append(re.sub(r"LF", "f", mask[1]) % tuple(given))
        elif line.startswith("L "):
            words, _, rest = line.removeprefix("L ").partition(" R0 ")
            assert rest.endswith(" M91")
            machine.move(_words(words))
        else:
            known = r"BEGIN PGM .*|CYCL DEF (?:8|9|10|11)\..*|M5|M9|STOP|; .*|LBL \d+|TCH PROBE 4\.0 MEASURING IN 3-D"
            assert re.fullmatch(known, line), line
    return machine.log


CONTROLS = {"fanuc": run_fanuc, "sinumerik": run_sinumerik, "heidenhain": run_heidenhain}
