"""The command `etendue` that the wheel installs."""

from __future__ import annotations

import signal
import sys

from etendue import _etendue


def main() -> int:
    command = getattr(_etendue, "command", None)
    if command is None:
        print("error: this package was built without the command etendue", file=sys.stderr)
        return 3
    # The command has handlers of its own.
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    return command(["etendue", *sys.argv[1:]])


if __name__ == "__main__":
    sys.exit(main())
