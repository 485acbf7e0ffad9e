"""``navfmu`` and ``python -m navfmu``."""

import signal
import sys


def main() -> None:
    """The command line, which takes a moment to import; Ctrl-C is answered from the beginning."""
    try:
        from navfmu.cli.main import main as commands

        commands(prog_name="navfmu")
    except KeyboardInterrupt:
        print("navfmu: interrupted", file=sys.stderr)
        sys.exit(130)
    finally:
        signal.signal(signal.SIGINT, signal.SIG_IGN)  # the interpreter is on its way out


if __name__ == "__main__":
    main()
