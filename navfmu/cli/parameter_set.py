"""What commands share that write a parameter set for an FMU."""

from __future__ import annotations


def receiver(fmu, out, *sources, what="parameters"):
    """The FMU that gets what is written to ``out``, or None where nothing is; checked before there is any work.

    ``sources`` are the files that are read, over which nothing is written.
    """
    from navfmu.cli.place import elsewhere
    from navfmu.errors import NavfmuError
    from navfmu.system import shipped
    from navfmu.system.result import check_file

    if (fmu is None) != (out is None):
        raise NavfmuError(f"--fmu and --out belong together: the FMU that gets the {what}, and the .ssv to write")
    if out is None:
        return None
    check_file(out, ".ssv")
    elsewhere(out, "--out", *sources)
    return shipped.fmu(fmu)
