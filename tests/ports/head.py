"""A head that can be killed: doubles numbers, slowly, in two processes, into a folder."""

from __future__ import annotations

import sys
from pathlib import Path

from axiscal.ports.study.results import Processes, Results, run_missing
from tests.ports.deeds import doubled_slowly, numbers

if __name__ == "__main__":
    with Results(Path(sys.argv[1]), "text", "digest", {"axiscal": "1"}, resume=True) as results:
        run_missing(results, numbers(200), 200, doubled_slowly, Processes(2))
