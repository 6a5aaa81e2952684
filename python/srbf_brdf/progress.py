"""The progress of a fit: a bar in a terminal, one in a notebook, or a call of a function."""

from __future__ import annotations

import sys
import time

WIDTH = 40


def _text(share: float, start: float) -> str:
    seconds = time.monotonic() - start
    done = round(WIDTH * share)
    left = f", {seconds * (1 / share - 1):.0f} s left" if share > 0.03 else ""
    # Tenths of a second, which move where a share does not.
    return f"fit [{'=' * done}{' ' * (WIDTH - done)}] {100 * share:3.0f} %, {seconds:.1f} s{left}"


class Silent:
    """Shows nothing. The share of others never falls."""

    share = 0.0

    def update(self, share: float) -> None:
        self.share = max(self.share, share)
        self.show(self.share)

    def show(self, share: float) -> None:
        pass

    def close(self) -> None:
        pass


class Function(Silent):
    """Calls a function with the share that is done."""

    def __init__(self, function):
        self.show = function


class Terminal(Silent):
    """A bar on one line of standard error, which goes when it is done."""

    def __init__(self):
        self.start = time.monotonic()
        self.shown = 0

    def show(self, share: float) -> None:
        text = _text(share, self.start)
        sys.stderr.write("\r" + text.ljust(self.shown))
        sys.stderr.flush()
        self.shown = len(text)

    def close(self) -> None:
        if self.shown:
            sys.stderr.write("\r" + " " * self.shown + "\r")
            sys.stderr.flush()


class Notebook(Silent):
    """A bar under the cell of a notebook."""

    def __init__(self, display):
        self.start = time.monotonic()
        self.shown = 0.0
        self.handle = display({"text/plain": ""}, raw=True, display_id=True)

    def show(self, share: float) -> None:
        # A notebook redraws slowly.
        if time.monotonic() - self.shown > 0.5:
            self.shown = time.monotonic()
            text = _text(share, self.start)
            html = f'<progress value="{share:.4f}" max="1"></progress> {text.split("] ")[1]}'
            self.handle.update({"text/plain": text, "text/html": html}, raw=True)

    def close(self) -> None:
        self.handle.update({"text/plain": f"ended after {time.monotonic() - self.start:.0f} s"}, raw=True)


def show(progress):
    """What shows the progress that `fit` is asked for: None or True for a bar where somebody looks, False, or a function."""
    if callable(progress):
        return Function(progress)
    if progress is False:
        return Silent()
    if progress not in (None, True):
        raise ValueError(f"progress: True, False or a function is expected, not {progress!r}")
    ipython = sys.modules.get("IPython")
    shell = ipython.get_ipython() if ipython else None
    if shell is not None and hasattr(shell, "kernel"):
        from IPython.display import display

        return Notebook(display)
    return Terminal() if progress or sys.stderr.isatty() else Silent()
