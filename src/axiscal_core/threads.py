"""One thread for the linear algebra: the matrices are small, and threads that wait for each other cost time."""

from __future__ import annotations

from collections.abc import Callable
from functools import wraps
from typing import ParamSpec, TypeVar

P = ParamSpec("P")
Found = TypeVar("Found")


def one_thread(function: Callable[P, Found]) -> Callable[P, Found]:
    """Return the function as it runs with one thread."""

    @wraps(function)
    def held(*args: P.args, **kwargs: P.kwargs) -> Found:
        from threadpoolctl import threadpool_limits

        with threadpool_limits(limits=1, user_api="blas"):
            return function(*args, **kwargs)

    return held
