"""``navfmu`` and ``python -m navfmu``."""

import sys


def main() -> None:
    """The command line, which takes a moment to import; Ctrl-C is answered from the beginning."""
    try:
        from navfmu.cli.main import main as commands

        commands(prog_name="navfmu")
    except KeyboardInterrupt:
        print("navfmu: interrupted", file=sys.stderr)
        sys.exit(130)


if __name__ == "__main__":
    main()
