"""Work on many computers: a Dask cluster that somebody has started. Only this file knows Dask."""

from __future__ import annotations

import hashlib
import queue
import re
from collections.abc import Callable, Generator, Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from itertools import islice
from typing import TYPE_CHECKING, Any

from axiscal.campaign.possible import versions
from axiscal.document import shown
from axiscal.exceptions import SchedulerError
from axiscal.ports.study.study_case import TRIES, Done, Solve, WorkItem, answered, given_up

if TYPE_CHECKING:
    from distributed import Client, Future

IN_FLIGHT = 64
"""Questions that the scheduler holds at a time; the next one comes as one is answered."""
_CONNECT, _WORKERS = 15.0, 60.0
"""Seconds to wait for a scheduler, and for its first worker."""
_LOOK, _LOST = 1.0, 30.0
"""Seconds between two looks whether the scheduler is there, and after which it is given up."""
_ADDRESS = re.compile(r"(tcp|tls)://([^\s/:]+|\[[0-9a-fA-F:.]+\]):[0-9]{1,5}")
_LOCAL = re.compile(r"tcp://(127\.0\.0\.1|localhost|\[::1\])(:\d+)?/?")


@dataclass(frozen=True, slots=True)
class Cluster:
    """An engine of all workers of a scheduler.  digest : of the study, so that two studies are told apart"""

    address: str
    digest: str

    def __call__(self, solve: Solve, questions: Iterable[WorkItem]) -> Generator[Done]:
        """Yield what comes of questions; raises SchedulerError where the scheduler is not there, or goes away."""
        waiting, come, asked = iter(questions), queue.Queue[Any](), dict[str, WorkItem]()
        with _connected(self.address) as client:

            def send(question: WorkItem) -> None:
                name = f"{self.digest[:16]}-{hashlib.sha256(question.key.encode()).hexdigest()}"
                asked[name] = question
                call = client.submit(
                    same_version, versions()["axiscal"], solve, question, key=name, retries=TRIES - 1, pure=True
                )
                call.add_done_callback(come.put)

            for question in islice(waiting, IN_FLIGHT):
                send(question)
            while asked:
                future = _next(client, come, self.address)
                found = _result(client, future, asked.pop(future.key), self.address)
                future.release()
                for question in islice(waiting, 1):
                    send(question)
                yield found

    @property
    def open_to_others(self) -> bool:
        """Whether whoever reaches the scheduler could let the workers run anything."""
        return not self.address.startswith("tls://") and _LOCAL.fullmatch(self.address) is None


def same_version(version: str, solve: Solve, question: WorkItem) -> Done | str:
    """Return what comes of a question, or the version of a worker that is another than that of the head."""
    own = versions()["axiscal"]
    return answered(solve, question) if own == version else own


def _next(client: Client, come: queue.Queue[Any], address: str) -> Future:
    """Return the next future that has ended; raises SchedulerError where the scheduler is gone for too long."""
    return _patiently(client, lambda: come.get(timeout=_LOOK), _LOOK, address)


def _patiently(client: Client, look: Callable[[], Any], seconds: float, address: str) -> Any:
    """Return what is found by looking for so many seconds, again and again while the scheduler is there."""
    lost = 0.0
    while True:
        try:
            return look()
        except (queue.Empty, TimeoutError):
            lost = 0.0 if client.status == "running" else lost + seconds
            if lost >= _LOST or client.status in ("closed", "closing"):
                raise _gone(address) from None


def _result(client: Client, future: Future, question: WorkItem, address: str) -> Done:
    """Return what came of a question: of one whose worker was killed with the answer, once another has found it."""
    from distributed import CancelledError
    from distributed.scheduler import KilledWorker

    try:
        found = _patiently(client, lambda: future.result(timeout=_LOST), _LOST, address)
    except KilledWorker:
        return given_up(question)
    except ModuleNotFoundError as fault:
        what, remedy = "a worker of {address} lacks {module}", "Install the same axiscal wherever a worker runs"
        raise SchedulerError(what, remedy, address=address, module=fault.name) from None
    except (OSError, CancelledError):
        raise _gone(address) from None
    if isinstance(found, str):
        what = "a worker of {address} has axiscal {found}, and this is {own}"
        remedy = "Install the same axiscal wherever a worker runs"
        raise SchedulerError(what, remedy, address=address, found=found, own=versions()["axiscal"])
    return Done(*found)


def _gone(address: str) -> SchedulerError:
    remedy = "Start it again, then go on with --resume"
    return SchedulerError("the scheduler at {address} went away", remedy, address=address)


@contextmanager
def _connected(address: str) -> Iterator[Client]:
    """Yield a client of a scheduler that has a worker; raises SchedulerError where there is none."""
    try:
        from distributed import Client
    except ImportError:
        remedy = 'Install it by pip install "axiscal[dask]", or leave --scheduler out and work on this computer'
        raise SchedulerError("Dask is not installed, which --scheduler needs", remedy) from None
    if not _ADDRESS.fullmatch(address):
        remedy = "Write one such as tcp://192.168.1.5:8786 or tls://HOST:8786"
        raise SchedulerError("{text} is no address of a scheduler", remedy, text=shown(address))
    try:
        client = Client(address, timeout=_CONNECT, name="axiscal")
    except (OSError, TimeoutError):
        remedy = (
            "See whether it runs and the address is right, or start one by: dask scheduler --host HOST; and on each "
            "computer that works: dask worker --nthreads 1 {address}"
        )
        raise SchedulerError("no scheduler answers at {address}", remedy, address=address) from None
    except TypeError as fault:  # how Dask says that nothing names its certificates
        remedy = "Name them in Dask's configuration: distributed.comm.tls"
        raise SchedulerError("{address} needs certificates: {reason}", remedy, address=address, reason=fault) from None
    try:
        try:
            client.wait_for_workers(1, timeout=_WORKERS)
        except TimeoutError:
            remedy = "On each computer that is to work: dask worker --nthreads 1 {address}"
            raise SchedulerError("the scheduler at {address} has no worker", remedy, address=address) from None
        yield client
    finally:
        client.close(timeout=_LOOK)
