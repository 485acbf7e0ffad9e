"""What ends a command: a problem that the user can mend is one sentence and an exit code, not a traceback."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager

from navfmu.errors import NavfmuError, quoted
from navfmu.files.reading import out_of_reach
from navfmu.terminal import streams
from navfmu.terminal.sentence import tell


@contextmanager
def as_a_sentence(program: str) -> Iterator[None]:
    """What is refused inside ends ``program``; the net below everything that tells of files more closely."""
    streams.complete()
    try:
        yield
    except NavfmuError as error:
        _end(program, error)
    except BrokenPipeError:  # the reader of our output went away, as "head" does
        sys.stderr.close()
        sys.exit(1)
    except OSError as error:
        _end(program, _sentence(error))


def _end(program: str, error: NavfmuError) -> None:
    tell(f"{program}: {error}")
    sys.exit(error.exit_code)


def _sentence(error: OSError) -> NavfmuError:
    """Of which file, if the system says that; where the current folder is gone it does not."""
    if error.filename is not None:
        return out_of_reach(error.filename, error)
    try:
        os.getcwd()
    except OSError as gone:
        return out_of_reach("the current folder", gone)
    return NavfmuError(f"the system refuses: {quoted(error.strerror or str(error) or type(error).__name__)}")
