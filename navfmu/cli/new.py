"""``navfmu new``: a component to start from."""

from __future__ import annotations

import importlib.util
import keyword
import re
import sys
from pathlib import Path

import click

from navfmu.errors import NavfmuError

_TEMPLATE = Path(__file__).parent / "templates" / "component.py.j2"


def new(name: str, folder: str | Path = ".") -> Path:
    """Write ``folder/NAME.py``, a component that builds and runs as it stands; return its path."""
    from navfmu.files.reading import what_is
    from navfmu.files.writing import write_file
    from navfmu.report.template import fill

    path = Path(folder) / f"{name}.py"
    _check(name)
    if what_is(path) is not None:
        raise NavfmuError(f"{path} exists already; choose another name, or move the file away")
    if importlib.util.find_spec(name) is not None:
        raise NavfmuError(f"'{name}' is the name of a Python module, which the file would hide; choose another name")
    class_name = "".join(part.capitalize() for part in name.split("_"))
    again = re.sub(r"(?<=[a-z0-9])(?=[A-Z])", "_", class_name).lower()
    title = name.replace("_", " ").capitalize()
    return write_file(path, fill(_TEMPLATE, name=name, class_name=class_name, title=title, named=again != name))


def _check(name: str) -> None:
    if not re.fullmatch(r"[a-z][a-z0-9]*(_[a-z0-9]+)*", name):
        words = re.findall(r"[A-Z]?[a-z0-9]+|[A-Z]+", name)
        better = re.sub(r"^[\d_]+", "", "_".join(words).lower())
        hint = f"; did you mean '{better}'?" if better else ""
        raise NavfmuError(
            f"'{name}' cannot name a component; expected small letters, digits and single underscores, first a letter, "
            f"such as radio_altimeter{hint}"
        )
    if keyword.iskeyword(name) or keyword.issoftkeyword(name) or name in sys.stdlib_module_names:
        raise NavfmuError(f"'{name}' means something else in Python; choose another name, such as my_{name}")


@click.command("new")
@click.argument("name")
@click.option("--folder", default=".", show_default=True, metavar="DIR", help="Where to write NAME.py.")
def command(name: str, folder: str) -> None:
    """Write NAME.py, a component to start from: it has an input, a measurement with noise, a fault and one task."""
    path = new(name, folder)
    click.echo(f"wrote {path}\ntry and build it:  python {path}")
