"""A height map as each program writes it: the words are theirs, the heights are drawn."""

import json
from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from axiscal.numerics import Array


@dataclass(frozen=True, eq=False, slots=True)
class DrawnMap:
    """A map, mm.  x : (n,); y : (k,); z : (k, n), nan where nobody probed"""

    x: Array
    y: Array
    z: Array

    def text(self, form: str) -> str:
        """Return the map as a program writes it."""
        return FORMS[form](self)

    def probed(self) -> dict[tuple[float, float], float]:
        """Return the heights by place, mm, of the cells that were probed."""
        nodes = {(x, y): self.z[j, i] for j, y in enumerate(self.y) for i, x in enumerate(self.x)}
        return {(round(float(x), 6), round(float(y), 6)): float(z) for (x, y), z in nodes.items() if not np.isnan(z)}


def drawn(x: tuple[float, float, int], y: tuple[float, float, int], seed: int, holes: int = 0) -> DrawnMap:
    """Return a map of heights to a thousandth of a mm; its corners are probed."""
    rng = np.random.default_rng(seed)
    z = np.round(rng.normal(0.0, 0.2, (y[2], x[2])), 3)
    inner = rng.permutation((y[2] - 2) * (x[2] - 2))[:holes]
    z[1 + inner // (x[2] - 2), 1 + inner % (x[2] - 2)] = np.nan
    return DrawnMap(np.linspace(*x), np.linspace(*y), z)


def _cell(value: float, none: str, form: str = "{:+.3f}") -> str:
    return none if np.isnan(value) else form.format(value)


def _rows(found: DrawnMap, none: str, between: str, form: str = "{:.3f}") -> list[str]:
    return [between.join(_cell(value, none, form) for value in row) for row in found.z]


def _unlabelled(found: DrawnMap, height: str, way: int) -> str:
    """Return a mesh without labels, the first row along y first, or last."""
    return "\n".join(
        [f"Num X,Y: 9,9\nZ search height: {height}\nMeasured points:", *_rows(found, "nan", "  ")[::way], ""]
    )


def _bilinear(found: DrawnMap) -> str:
    rows = [f"Recv: {j:2} {row}" for j, row in enumerate(_rows(found, " =====", " ", "{:+.3f}"))]
    head = "Recv:       " + "      ".join(str(i) for i in range(len(found.x)))
    finer = ["Recv: Subdivided with CATMULL ROM Leveling Grid:", head, *rows, "Recv: ok T:20.1 /0.0"]
    return "\n".join(["Send: M420 V", "Recv: Bilinear Leveling Grid:", head, *rows, *finer])


def _nodes(found: DrawnMap, start: str, end: str = "") -> str:
    nodes = ((i, j, z) for j, row in enumerate(found.z) for i, z in enumerate(row) if not np.isnan(z))
    return "M420 S0\n" + "".join(f"{start} I{i} J{j} Z{z:.3f}{end}\n" for i, j, z in nodes) + "M420 S1\n"


def _points(found: DrawnMap, form: str) -> str:
    return "".join(form.format(x=x, y=y, z=z) for (x, y), z in found.probed().items())


def _bcnc(found: DrawnMap) -> str:
    sides = (f"{side[0]:g} {side[-1]:g} {len(side)}\n" for side in (found.x, found.y))
    return "".join([*sides, "-1 5 100\n\n\n", _points(found, "{x:g} {y:g} {z:g}\n")])


def _candle(found: DrawnMap) -> str:
    x, y = found.x, found.y
    head = f"{x[0]:.2f};{y[0]:.2f};{x[-1] - x[0]:.2f};{y[-1] - y[0]:.2f}\r\n{len(x)};{len(y)};-1.00;1.00\r\n0;20;20\r\n"
    return head + "\r\n".join(_rows(found, "nan", ";", "{:.10g}"))


def _mesh(found: DrawnMap) -> str:
    rows = "\n".join(f"  {row}" for row in _rows(found, "nan", ", "))
    keys = {"version": 1, "x_count": len(found.x), "y_count": len(found.y), "min_x": found.x[0], "max_x": found.x[-1]}
    keys |= {"min_y": found.y[0], "max_y": found.y[-1], "algo": "lagrange", "mesh_x_pps": 2}
    said = "\n".join(f"{key}: {value}" for key, value in keys.items())
    return f"[include a.cfg]\n\n[bed_mesh PEI 60]\n{said}\npoints:\n{rows}\n\n[fan]\npin: P1\n"


def _moonraker(found: DrawnMap) -> str:
    ends = {"mesh_min": [found.x[0], found.y[0]], "mesh_max": [found.x[-1], found.y[-1]]}
    saved = {"points": [[0.0, 9.0], [9.0, 0.0]], "mesh_params": {}}
    mesh = {"profile_name": "now", **ends, "probed_matrix": found.z.tolist(), "profiles": {"old": saved}}
    return json.dumps({"result": {"eventtime": 1.5, "status": {"bed_mesh": mesh}}}, indent=1)


def _console(found: DrawnMap) -> str:
    finer = "Recv: // Mesh X,Y: 9,9\n// Measured points:\n  9.000000  9.000000\n"
    return (
        "14:05:30  // Mesh Leveling Probed Z positions:\n"
        + "".join(f"Recv: //  {row}\n" for row in _rows(found, "nan", " ", "{:.6f}"))
        + finer
    )


def _height_map(found: DrawnMap) -> str:
    x, y = found.x, found.y
    sides = f"{x[0]},{x[-1]},{y[0]},{y[-1]},-1.00,{x[1] - x[0]},{y[1] - y[0]},{len(x)},{len(y)}"
    head = "RepRapFirmware height map file v2 generated at 2026-01-01 10:00\n"
    keys = "xmin,xmax,ymin,ymax,radius,xspacing,yspacing,xnum,ynum\n"
    return head + keys + sides + "\n" + "\n".join(_rows(found, "0", ",", "{:7.3f}")) + "\n"


FORMS: Mapping[str, Callable[[DrawnMap], str]] = {
    "a Marlin map (M420 V)": _bilinear,
    "a Marlin map (M421, M503)": lambda found: _nodes(found, "echo:  G29 W"),
    "a Marlin map (M421, M503), as G-code": lambda found: _nodes(found, "N7 M421", " ; from a slicer"),
    "touches as a firmware printed them, of Marlin": lambda found: _points(
        found, "Recv: Bed X: {x:.3f} Y: {y:.3f} Z: {z:.3f}\n"
    ),
    "touches as a firmware printed them, of Klipper": lambda found: _points(
        found, "// probe at {x:.3f},{y:.3f} is z={z:.6f}\n"
    ),
    "touches as a firmware printed them, of Klipper since 2025": lambda found: _points(
        found, "14:02:11  // probe: at {x:.3f},{y:.3f} bed will contact at z={z:.6f}\n"
    ),
    "touches as a firmware printed them, of Marlin in a log with dates": lambda found: _points(
        found, "[2026-11-20 10:11:12.345] Recv: Bed X: {x:.3f} Y: {y:.3f} Z: {z:.3f}\n"
    ),
    "touches as a firmware printed them, of Marlin in a log of Repetier-Host": lambda found: _points(
        found, "12:33:44.123 : Bed X: {x:.3f} Y: {y:.3f} Z: {z:.3f}\n"
    ),
    "touches as a firmware printed them, of grbl": lambda found: (
        "[PRB:0.000,0.000,-9.000:0]\nALARM:5\n"
        + _points(found, ">>> G38.2 Z-5 F50\n[PRB:{x:.3f},{y:.3f},{z:.3f}:1]\nok\n")
    ),
    "touches as a firmware printed them, of grbl of four axes": lambda found: _points(
        found, "[PRB:{x:.3f},{y:.3f},{z:.3f},0.000:1]\n"
    ),
    "touches as a firmware printed them, of TinyG": lambda found: _points(
        found, '{{"r":{{"prb":{{"e":1,"x":{x:.3f},"y":{y:.3f},"z":{z:.3f},"a":0.000}}}},"f":[1,0,23]}}\n'
    ),
    "touches as a firmware printed them, of Smoothieware": lambda found: _points(
        found, "Recv: DEBUG: X{x:.4f}, Y{y:.4f}, Z{z:.4f}\n"
    ),
    "touches as a firmware printed them, of Repetier": lambda found: _points(
        found, "15:33:28.605 : G33 X{x:.2f} Y{y:.2f} Z{z:.3f}\n"
    ),
    "touches as a firmware printed them, of Klipper on a page": lambda found: _points(
        found, "1/12/2026, 12:50:51 PM | probe at {x:.3f},{y:.3f} is z={z:.6f}\n"
    ),
    "a bCNC probe file": _bcnc,
    "a Candle height map": _candle,
    "a Moonraker mesh, in a notice": lambda found: '{"method": "notify", "params": [' + _moonraker(found) + ", 1.5]}",
    "a Marlin map (M420 V), of Marlin 1": lambda found: "Num X,Y: 9,9\nMeasured points:" + _bilinear(found)[42:],
    "a Marlin map (M420 V), of 2015": lambda found: _unlabelled(found, "4\nZ offset: 0.00000", 1),
    "a Marlin map (M420 V), of a Prusa": lambda found: _unlabelled(found, "5.00", -1),
    "touches as a firmware printed them, of screws of Klipper": lambda found: _points(
        found, "// rear left : x={x:.1f}, y={y:.1f}, z={z:.5f} : adjust CCW 00:50\n"
    ),
    "a list of points X Y Z": lambda found: "# UGS\n" + _points(found, "{x} {y} {z}\n"),
    "a list of points X Y Z, with commas": lambda found: "X,Y,Z\n" + _points(found, "{x},{y},{z}\n"),
    "a list of points X Y Z, behind their names": lambda found: (
        "// Group Target X Y Z\n"
        + "".join(
            f"Main p{number}, {line}" for number, line in enumerate(_points(found, "{x}, {y}, {z}\n").splitlines(True))
        )
    ),
    "a list of points X Y Z, of nine axes": lambda found: _points(found, "{x:.6f} {y:.6f} {z:.6f}" + 6 * " 0.0" + "\n"),
    "a list of points X Y Z, with decimal commas": lambda found: _points(found, "{x};{y};{z}\n").replace(".", ","),
    "a Klipper mesh": _mesh,
    "a Moonraker mesh": _moonraker,
    "a mesh of the Klipper console": _console,
    "a RepRapFirmware map": _height_map,
}
"""By the title by which it is recognised, with its kind behind a comma."""
EVERYWHERE = {each for each in FORMS if each.startswith(("a bCNC", "a Moonraker", "a Klipper mesh", "a mesh of"))}
"""Programs that probe every cell, or none."""
