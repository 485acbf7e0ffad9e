"""``navfmu`` and ``python -m navfmu``."""


def main() -> None:
    """The command line, which takes a moment to import; Ctrl-C is answered from the beginning."""
    try:
        import signal

        signal.signal(signal.SIGINT, _end)
        from navfmu.cli.main import main as commands

        commands(prog_name="navfmu")
    except KeyboardInterrupt:
        _end()
    finally:
        signal.signal(signal.SIGINT, signal.SIG_IGN)  # the interpreter is on its way out


def _end(*_: object) -> None:
    """Nothing has begun yet. Not by an exception, which some imports drop and others make another one of."""
    import os

    os.write(2, b"navfmu: interrupted\n")
    os._exit(130)


if __name__ == "__main__":
    main()
