"""`python -m axiscal`."""

import sys

from axiscal.cli import main

sys.exit(main())
