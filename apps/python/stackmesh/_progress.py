"""Progress of a run."""

import contextlib
import sys


class _Lines:
    """A line on stderr for each stage."""

    def __init__(self):
        self._stage = None

    def __call__(self, stage, done):
        if stage != self._stage:
            self._stage = stage
            print(f"stackmesh: {stage}", file=sys.stderr, flush=True)

    def close(self):
        pass


class _Bar:
    """A bar of tqdm, which runs through each stage in turn."""

    def __init__(self, tqdm):
        self._bar, self._stage = tqdm(total=100, unit="%", bar_format="{desc}: {percentage:3.0f}%|{bar}| {elapsed}"), None

    def __call__(self, stage, done):
        if stage != self._stage:
            self._stage = stage
            self._bar.set_description(stage)
        self._bar.n = round(100 * done)
        self._bar.refresh()

    def close(self):
        self._bar.close()


@contextlib.contextmanager
def shown(progress):
    """What the compiled half calls; None: nothing."""
    if progress is None or progress is False:
        yield None
        return
    if progress is not True:
        yield progress
        return
    try:
        from tqdm.auto import tqdm

        bar = _Bar(tqdm)
    except ImportError:
        bar = _Lines()
    try:
        yield bar
    finally:
        bar.close()
