"""The program `etalon`."""

import signal
import sys

from . import _native


def main() -> int:
    """Runs the program on the arguments of the process and returns its exit code."""
    # Ctrl-C belongs to the program: it ends with what it has, and Python must not raise KeyboardInterrupt after it. A SIGINT that
    # is ignored, as under nohup, stays so.
    if signal.getsignal(signal.SIGINT) is signal.default_int_handler:
        signal.signal(signal.SIGINT, signal.SIG_DFL)
    return _native.main(["etalon", *sys.argv[1:]])
