"""A campaign.

The whole loop on one axis: ask, read, estimate, until the target is reached. `axiscal step run` does the same
from a shell.
"""

from pathlib import Path
from tempfile import TemporaryDirectory

import axiscal as ac
from axiscal.campaign.sources import open_source

CAMPAIGN = """
machine = "one-axis"
[target]
rms = "4 um"
readings = 40
[[setups]]
name = "laser along X"
instrument = "interferometer"
direction = "x"
approach = "both"
"""


def main() -> dict[str, object]:
    """Return why it stopped, and how the accuracy grew."""
    with TemporaryDirectory() as folder:
        file = Path(folder, "campaign.toml")
        file.write_text(CAMPAIGN, encoding="utf-8")
        description = ac.read_campaign(file)
        source = open_source("sim:7", ac.Simulator(description.machine, description.setups))
        with ac.Campaign.create(Path(folder, "axis.axiscal"), description) as campaign:
            rms = [campaign.estimate().accuracy.rms * 1e6]
            stopped = campaign.run(source, watch=lambda milestone: rms.append(milestone.accuracy.rms * 1e6))
    return {
        "stopped because": stopped,
        "RMS before, um": rms[0],
        "RMS at the end is below 4 um": rms[-1] <= 4.0,
        "picture": {"x": "readings", "y": "RMS, µm", "lines": {"known to": (list(range(len(rms))), rms)}},
    }


if __name__ == "__main__":
    print({name: value for name, value in main().items() if name != "picture"})
