"""The command `etendue`, as the wheel installs it."""

from __future__ import annotations

import signal
import sys

from etendue._etendue import command


def main() -> int:
    # The command has handlers of its own.
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    return command(["etendue", *sys.argv[1:]])


if __name__ == "__main__":
    sys.exit(main())
