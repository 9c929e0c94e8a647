"""Work in threads, and how far it is."""
import sys
import threading
import time
from collections.abc import Callable, Iterable
from concurrent.futures import ThreadPoolExecutor
from typing import Any

_INTERVAL_S = 5


def for_each(threads: int, items: Iterable[Any], work: Callable[[Any], None]) -> None:
    """Works on the items in their order, `threads` at a time. Raises the first exception of them; then no other begins."""
    with ThreadPoolExecutor(threads) as pool:
        futures = [pool.submit(work, item) for item in items]
        try:
            for future in futures:
                future.result()
        except BaseException:
            pool.shutdown(cancel_futures=True)
            raise


def _duration(seconds: float) -> str:
    return f"{seconds:.0f} s" if seconds < 120 else f"{seconds / 60:.0f} min"


class Progress:
    """Tells on standard error, now and then, how much is done. Threads may share it."""

    def __init__(self, stage: str, total: int) -> None:
        self._stage, self._total, self._done = stage, total, 0
        self._begin = self._told = time.monotonic()
        self._lock = threading.Lock()

    def advance(self) -> None:
        with self._lock:
            self._done += 1
            now = time.monotonic()
            if now - self._told < _INTERVAL_S:
                return
            self._told = now
            left = (now - self._begin) * (self._total - self._done) / self._done
            print(f"{self._stage}: {self._done} of {self._total}, {_duration(left)} to go", file=sys.stderr, flush=True)

    def finish(self) -> None:
        print(f"{self._stage}: {self._done} of {self._total} in {_duration(time.monotonic() - self._begin)}", file=sys.stderr, flush=True)
