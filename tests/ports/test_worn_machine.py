"""What tables add is taken off readings, whatever reads them: against exact kinematics."""

from __future__ import annotations

import numpy as np
import pytest

from axiscal.description.campaign import campaign_from_texts
from axiscal.machine import load_machine
from axiscal.machine.kinematics import Deviation, frames, tool_motion
from axiscal.measurement.reading import Reading
from axiscal.measurement.simulation import Simulator
from axiscal.numerics import Array
from axiscal.ports.fleet.worn_machine import without_tables

SETUPS = {
    "interferometer": ("one-axis", 'direction = "x"'),
    "probe": ("dmu60", 'direction = [1, 2, -1]\nmoves = ["X", "Y", "Z", "B", "C"]'),
    "level": ("dmu60", 'direction = "y"\nmoves = ["X", "Y", "Z", "B", "C"]'),
    "sphere": ("dmu60", 'station = ["80 mm", "30 mm", "-150 mm"]'),
    "tracker": ("three-axis-mill", 'station = ["-1500 mm", "900 mm", "200 mm"]\nmoves = ["X", "Y", "Z"]'),
    "tracer": ("three-axis-mill", 'station = ["-300 mm", "-200 mm", "-100 mm"]\nmoves = ["X", "Y", "Z"]'),
}


@pytest.mark.parametrize("instrument", SETUPS)
def test_what_is_taken_off_is_what_the_tables_add(instrument: str) -> None:
    name, keys = SETUPS[instrument]
    text = f'machine = "{name}"\n[target]\nreadings = 1\n[[setups]]\nname = "s"\ninstrument = "{instrument}"\n{keys}\n'
    described = campaign_from_texts(text, "c.toml", load_machine(name).text, name)
    machine, setups = described.machine, described.setups
    virtual = Simulator(machine, setups).drawn(1)
    rng, shown, tips = np.random.default_rng(5), list[Array](), list[Array]()
    low, high = np.array([axis.travel for axis in machine.axes]).T
    offset = 20e-6 * rng.standard_normal(len(low))

    def control(poses: Array, approaches: Array) -> Array:
        return np.where(approaches > 0, offset, -offset)

    pose, approach = rng.uniform(low, high), rng.choice([-1.0, 1.0], len(low))
    at, come = pose[None], approach[None]
    own = virtual.model.compose(virtual.values(at), come)
    for sent in (at, at + control(at, come)):
        found, nominal = tool_motion(machine, sent, own), frames(machine, at)
        turned = found.rotation[0] @ nominal.tool[0].T
        turn = np.array([turned[2, 1], turned[0, 2], turned[1, 0]])
        actual = Deviation(found.translation - nominal.tcp, turn[None])
        tips.append(found.translation)
        shown.append(np.array(virtual.exactly(setups[0], at, actual, come)))
    reading = Reading("s", tuple(pose), tuple(approach.astype(int).tolist()), shown[1][0], others=tuple(shown[1][1:]))
    (bare,) = without_tables([reading], machine, setups, control)
    assert np.max(np.abs(shown[1] - shown[0])) > 5e-7
    moved = float(np.linalg.norm(tips[1] - tips[0]))
    np.testing.assert_allclose(bare.values, shown[0], atol=0.005 * moved)  # a station is 5 mm of a metre off
