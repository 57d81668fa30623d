"""`python -m app` is `bohemia`: its first moment, until `app.cli` takes over."""

import signal
import sys

if signal.getsignal(signal.SIGINT) is signal.default_int_handler:
    # While all that is needed is loaded, Ctrl-C ends the process and says nothing.
    signal.signal(signal.SIGINT, signal.SIG_DFL)

from app.cli import main


def start() -> None:
    """Run the command that was typed, and exit."""
    sys.exit(main())


if __name__ == "__main__":
    start()
