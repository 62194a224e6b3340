"""What is described and read by nobody is said, and nothing else."""

from __future__ import annotations

from axiscal.description.artefacts import unused_artefacts

BALL = '[[artefacts]]\nname = "{}"\nballs = {{ one = ["{} mm", "0 mm", "0 mm"] }}\n'
TOUCHED = '[[setups]]\nname = "touched"\ninstrument = "sphere"\nartefact = "left"\n'


def said_of(*names: str) -> str | None:
    balls = "".join(BALL.format(name, 50 * number) for number, name in enumerate(names, start=1))
    return unused_artefacts(f'machine = "dmu60"\n{balls}{TOUCHED}')


def test_an_artefact_that_nobody_reads_is_named() -> None:
    assert said_of("left") is None
    said = said_of("left", "right")
    assert said is not None
    assert '"right"' in said
    assert '"left"' not in said
    assert "artefact = " in said
