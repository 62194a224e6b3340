"""Arrays in, arrays out; no word of machines."""

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
