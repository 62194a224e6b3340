"""How many threads the linear algebra may use: one, while axiscal plans or estimates.

Its matrices have some hundreds of rows, for which threads only wait for each other. A sum that is cut into as many
parts as a computer has cores has other last digits on another computer. The doors of planning and estimating are
decorated with `one_thread`; what the caller allows elsewhere stays as it is.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from threading import Lock, get_ident

from threadpoolctl import OpenBLASController, ThreadpoolController


class _Limit:
    """The limit, from the first door that is opened until the last is closed, by whichever thread of Python.

    The usual BLAS has one limit for the process, others one for each thread of Python.
    """

    def __init__(self) -> None:
        self._lock, self._doors, self._before = Lock(), 0, ExitStack()
        self._limited = set[int]()
        self._libraries: ThreadpoolController | None = None

    def enter(self) -> None:
        """Open a door."""
        with self._lock:
            self._doors += 1
            if get_ident() not in self._limited:
                self._hold()

    def leave(self) -> None:
        """Close a door; the last one gives back what was before the first."""
        with self._lock:
            self._doors -= 1
            if self._doors == 0:
                OpenBLASController.clear_controlling_thread(force=True)  # or only the first thread could give it back
                self._before.close()
                OpenBLASController.clear_controlling_thread(force=True)
                self._limited.clear()

    def look_again(self) -> None:
        """Find the libraries anew, and hold them as well if a door is open."""
        with self._lock:
            self._libraries = None
            if self._doors:
                self._hold()

    def _hold(self) -> None:
        self._libraries = self._libraries or ThreadpoolController()
        self._before.callback(self._libraries.limit(limits=1, user_api="blas").restore_original_limits)
        self._limited.add(get_ident())


_LIMIT = _Limit()


@contextmanager
def one_thread() -> Iterator[None]:
    """Hold BLAS to one thread in a `with` or, as a decorator, in a function; doors may be nested."""
    _LIMIT.enter()
    try:
        yield
    finally:
        _LIMIT.leave()


hold_loaded_libraries = _LIMIT.look_again
"""Apply the limit to a BLAS that has been loaded just now: that of numpy, or the other one that scipy brings."""
