"""The words that a report explains on its own pages."""

from axiscal.language.spoken import later, said

_WORDS = (
    (
        later("Tool point"),
        later(
            "where the tool cuts, relative to the workpiece. Errors and uncertainties are those of this point "
            "over the volume that is stated."
        ),
    ),
    (
        later("U"),
        later(
            "expanded uncertainty: with 95 % the error that is left after correcting by the estimate is not "
            "larger, over the volume. In space it is a length, along an axis a ±. k is U over the standard "
            "uncertainty."
        ),
    ),
    (
        later("RMS"),
        later("root of the mean square over the volume."),
    ),
    (
        later("Band, ±"),
        later("95 %, with what the model cannot follow."),
    ),
    (
        later("EXX, EYX, ECX …"),
        later(
            "errors after ISO 230-1: E, the direction of the error (X, Y, Z along, A, B, C about an axis), the "
            "axis that moves. C0Y: how far Y is out of square about C. A reversal is what an error differs by "
            "between both sides from which an axis comes."
        ),
    ),
    (
        later("Before measuring"),
        later("what was stated of the machine before any reading: how large each error may be."),
    ),
    (
        later("Surprise"),
        later("a reading less what was expected of it just before, in standard deviations of that difference."),
    ),
)


def words() -> list[tuple[str, str]]:
    """Return each word with what it means."""
    return [(said(word), said(meaning)) for word, meaning in _WORDS]
