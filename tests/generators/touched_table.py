"""A five-axis machine that touches spheres on its table, and where its axes stand when it meets one.

By rotation matrices of its own. The axis lines of its rotary axes are a little off where machine.toml has them, and
nothing else is.
"""

import numpy as np

from axiscal.description.campaign import CampaignDescription, campaign_from_texts
from axiscal.measurement.candidates import chart_candidates
from axiscal.measurement.reading import Place
from axiscal.numerics import Array
from tests.generators.kinematics import first_met
from tests.generators.texts import artefact_text, campaign_text, machine_text, setup_text

MACHINE = machine_text(
    "w-C'-A'-b-X-Y-Z-t",
    {"X": (-200, 200), "Y": (-200, 200), "Z": (-200, 200), "A": (-60, 60), "C": (0, 360)},
    {"Y0A Z0A X0C Y0C": "60 um"},
    tool=80,
    name="table",
    origins={"A": (0, 0, -120), "C": (0, 0, -100)},
).replace("[tool]", '[tool]\nstylus = "6 mm"')
CAMPAIGN = campaign_text(
    "machine.toml",
    artefact_text(
        "spheres",
        balls={"near": ["60 mm", "-20 mm", "-90 mm"], "far": ["-50 mm", "40 mm", "-70 mm"]},
        placed="50 um",
        diameter="25 mm",
    ),
    setup_text("spheres, touched", "sphere", artefact="spheres", settle="0 s", noise="1 um"),
    target={"readings": 8},
)
RADIUS = 15.5
"""mm, of sphere and stylus."""
OFF = {"Y0A": 31.0, "Z0A": -18.0, "X0C": 12.0, "Y0C": -25.0}
"""um: where the axis lines are against where they are stated; the table rides on the cradle."""
LINES = {
    "ay": OFF["Y0A"] / 1e3,
    "az": -120.0 + OFF["Z0A"] / 1e3,
    "cx": OFF["X0C"] / 1e3,
    "cy": (OFF["Y0A"] + OFF["Y0C"]) / 1e3,
}
BALLS = {"near": (60.0, -20.0, -90.0), "far": (-50.0, 40.0, -70.0)}


def description() -> CampaignDescription:
    return campaign_from_texts(CAMPAIGN, "campaign.toml", MACHINE, "machine.toml")


def places(campaign: CampaignDescription, count: int) -> list[Place]:
    """Return places spread over what can be read."""
    (setup,) = campaign.setups
    assert setup.chart is not None
    poses, approaches = chart_candidates(campaign.machine, setup, setup.chart, count)
    sides = approaches.astype(int).tolist()
    return [Place(setup.name, tuple(p), tuple(s)) for p, s in zip(poses.tolist(), sides, strict=True)]


def tip(at: dict[str, float], lines: dict[str, float] | None = None) -> Array:
    """Return where the tip is on the workpiece, mm.  at : mm and deg by axis; lines : where the axis lines are"""
    where = LINES if lines is None else lines
    p = np.array([at["X"], at["Y"], at["Z"] - 80.0])
    a, c = np.radians(at["A"]), np.radians(at["C"])
    off = np.array([0.0, where["ay"], where["az"]])
    p = np.array([[1, 0, 0], [0, np.cos(a), -np.sin(a)], [0, np.sin(a), np.cos(a)]]) @ (p - off) + off
    off = np.array([where["cx"], where["cy"], 0.0])
    turned: Array = np.array([[np.cos(c), -np.sin(c), 0], [np.sin(c), np.cos(c), 0], [0, 0, 1]]) @ (p - off) + off
    return turned


STATED = {"ay": 0.0, "az": -120.0, "cx": 0.0, "cy": 0.0}


def met(start: dict[str, float], stop: dict[str, float]) -> dict[str, float] | None:
    """Return where a straight way of the linear axes meets a sphere first, mm and deg; None where it meets none."""
    share = first_met(tip(start), tip(stop), map(np.array, BALLS.values()), RADIUS)
    return None if share is None else {axis: at + share * (stop[axis] - at) for axis, at in start.items()}


def expected(place: dict[str, float], ball: str) -> Array:
    """Return what is read in a pose, um: the ball as stated less where it is found.  place : rotary axes, deg"""
    at = {"X": 0.0, "Y": 0.0, "Z": 0.0, **place}
    for _ in range(50):  # the linear axes go until the true tip is in the ball
        away = np.array(BALLS[ball]) - tip(at)
        base = tip(at)
        ways = np.array([tip(at | {axis: at[axis] + 1.0}) - base for axis in "XYZ"]).T
        at |= dict(zip("XYZ", np.array([at[axis] for axis in "XYZ"]) + np.linalg.solve(ways, away), strict=True))
    return 1e3 * (np.array(BALLS[ball]) - tip(at, STATED))


def expected_at(campaign: CampaignDescription, place: Place) -> Array:
    """Return what is read at a place, um."""
    named = zip(campaign.machine.axes, place.pose, strict=True)
    at = {axis.name: float(np.degrees(value) if axis.rotary else 1e3 * value) for axis, value in named}
    ball = min(BALLS, key=lambda name: float(np.linalg.norm(tip(at, STATED) - BALLS[name])))
    return expected({axis: at[axis] for axis in "AC"}, ball)
