"""Klipper's own bed mesh: its height at places, and the nodes that it counts, in a Python of its own."""

import json
import re
import subprocess
import sys
from collections.abc import Sequence
from typing import Any

from tests.controls.klipper_host import klipper

_ASKED = """
import collections, json, sys, types
sys.path.insert(0, sys.argv[1])
from extras import bed_mesh
asked, said = json.load(sys.stdin), []
for params, points, place in asked["heights"]:
    mesh = bed_mesh.ZMesh(params, "asked")
    mesh.build_mesh(points)
    said.append(mesh.calc_z(*place))
for low, high, counts, radius, origin in asked["nodes"]:
    probes = object.__new__(bed_mesh.ProbeManager)
    probes.zero_ref_pos, probes.faulty_regions, probes.cfg_overshoot = None, [], 0
    probes.substitutes, probes.orig_config = collections.OrderedDict(), {"mesh_min": low, "mesh_max": high}
    probes.probe_helper = types.SimpleNamespace(update_probe_points=lambda *points: None)
    probes.generate_points({"x_count": counts[0], "y_count": counts[1]}, low, high, radius, origin)
    said.append(probes.base_points)
print(json.dumps(said))
"""


def held(text: str, place: tuple[float, float]) -> tuple[dict[str, Any], list[list[float]], tuple[float, float]]:
    """Return what a height is asked by: keys and points of the only profile of a text, as saved, and a place, mm."""
    saved = text.split("[bed_mesh ", 1)[1].partition("\n")[2].replace("#*#", "")
    points = [line for line in saved.splitlines() if line.count(",")]
    keys = dict(re.findall(r"(\w+) *= *(\S+)", saved))
    numbers = {key: float(value) if "." in value else int(value) for key, value in keys.items() if key != "algo"}
    return numbers | {"algo": keys["algo"]}, [[float(each) for each in line.split(",")] for line in points], place


def asked(heights: Sequence[object] = (), nodes: Sequence[object] = ()) -> list[Any]:
    """Return heights, mm, of (keys, points, place), and lists of nodes of (low, high, counts, radius, origin)."""
    given = json.dumps({"heights": heights, "nodes": nodes})
    words = [sys.executable, "-c", _ASKED, str(klipper() / "klippy")]
    done = subprocess.run(words, input=given, capture_output=True, text=True, timeout=60, check=True)
    found: list[Any] = json.loads(done.stdout)
    return found
