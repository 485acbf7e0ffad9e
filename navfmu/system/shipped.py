"""What comes with the package: built FMUs and systems, in the wheel's ``shipped`` folder or the checkout's ``dist``."""

from __future__ import annotations

from pathlib import Path

from navfmu.errors import NavfmuError, nearest
from navfmu.files.reading import what_is

_PACKAGE = Path(__file__).resolve().parents[1]


def folders() -> list[Path]:
    """Folders that hold shipped files, preferred one first: the checkout's build, then the wheel's."""
    candidates = [_PACKAGE.parent / "dist", _PACKAGE / "shipped"]
    if not (_PACKAGE.parent / "pyproject.toml").is_file():  # installed: a neighbour called "dist" is not ours
        candidates = candidates[1:]
    return [folder for folder in candidates if what_is(folder) == "a folder"]


def find(name: str) -> Path | None:
    """A shipped file by its name, for example "imu.fmu"."""
    return next((folder / name for folder in folders() if what_is(folder / name) == "a file"), None)


def path(name: str) -> Path:
    """A shipped file by its name, or a sentence that lists what there is."""
    found = find(name)
    if found is None:
        raise NavfmuError(f"'{name}' is not shipped with navfmu{nearest(name, names(Path(name).suffix))}")
    return found


def names(suffix: str = "") -> list[str]:
    """Names of shipped files with an ending such as ".ssp"."""
    return sorted({file.name for folder in folders() for file in folder.glob(f"*{suffix}") if file.is_file()})


def system(name: str) -> Path:
    """A system or FMU by path, or a shipped system by its bare name ("backup_navigator")."""
    return Path(name) if name.strip() and what_is(name) is not None else named(name)


def fmu(name: str) -> Path:
    """An FMU by path, or a shipped one by its name, with or without its ending ("imu")."""
    if not name.strip():
        raise NavfmuError("the name of the FMU is empty")
    file = Path(name)
    if what_is(file) == "a file":
        return file
    full = file.name if file.suffix else f"{file.name}.fmu"
    found = find(full) if file.parent == Path() else None
    if found is None:
        there = what_is(file)
        said = f"is {there}" if there else "no such file, and no FMU of that name is shipped"
        raise NavfmuError(f"{name}: {said}; expected an FMU{nearest(full, names('.fmu'))}")
    return found


def named(name: str) -> Path:
    """A shipped system by its bare name, whatever the current folder holds."""
    file = Path(name)
    if not name.strip():
        raise NavfmuError("the name of the system is empty")
    if file.parent == Path() and file.suffix in ("", ".ssp", ".fmu"):
        found = find(file.name if file.suffix else f"{file.name}.ssp")
        if found is not None:
            return found
        if not file.suffix:
            known = [Path(n).stem for n in names(".ssp")]
            have = f" (shipped: {', '.join(known)})" if known else ""
            raise NavfmuError(f"there is no file and no shipped system named '{name}'{nearest(name, known)}{have}")
    hint = nearest(file.name, names(file.suffix)) if file.parent == Path() else ""
    kinds = "an .ssp, an .ssd, an .fmu or a folder with SystemStructure.ssd"
    raise NavfmuError(f"{name}: no such file; expected {kinds}{hint}")
