"""The look at shapes finds what contradicts a docstring."""

import numpy as np
import pytest

from axiscal_core.eigen import settled
from tests.shapes import ShapeSaidError


def test_the_package_is_looked_at() -> None:
    with pytest.raises(ShapeSaidError, match="settled: values is said to be"):
        settled(np.eye(2), np.eye(2))
