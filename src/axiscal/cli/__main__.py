"""`python -m axiscal.cli`."""

import sys

from axiscal.cli import main

sys.exit(main())
