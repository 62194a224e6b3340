"""Write what is said today: `python -m tests.refusals`. What it changes is to be read before it is kept."""

from tests.refusals.reading import kinds, refusals, said, written

if __name__ == "__main__":
    for kind in kinds():
        held = refusals(kind)
        written(kind, [row._replace(says=said(kind, row.of, held.text(row))) for row in held.rows])
