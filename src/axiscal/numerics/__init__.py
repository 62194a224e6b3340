"""Arrays in, arrays out; nothing here knows of machines."""

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
