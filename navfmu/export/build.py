"""From components to .fmu files: trace, generate, compile for each platform, illustrate, pack; each once."""

from __future__ import annotations

import hashlib
import importlib.util
import os
import shutil
import tempfile
from collections.abc import Callable, Iterable
from concurrent.futures import Future, ThreadPoolExecutor, wait
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from navfmu.errors import NavfmuError
from navfmu.export import archive, description, life, toolchain
from navfmu.export.fingerprint import fingerprint
from navfmu.export.page import documentation
from navfmu.export.page.illustration import Illustration, illustrate
from navfmu.export.printing import codegen
from navfmu.export.record import ir
from navfmu.files import cache
from navfmu.files.reading import what_is
from navfmu.files.writing import write_file

RUNTIME = Path(__file__).parent / "runtime"
LICENSES = Path(__file__).parent / "licenses"
#: What the compiler is given of these; it includes the others.
UNIT = "fmu.c"

#: ``progress(done, total, note)``
Progress = Callable[[int, int, str], None]


@dataclass(frozen=True)
class Built:
    """One finished FMU."""

    path: Path
    unchanged: bool  # taken from the cache


@dataclass(frozen=True)
class Sources:
    """What one FMU is made of, before it is compiled."""

    model: ir.Model
    guid: str
    units: tuple[str, ...]  # what the compiler is given
    files: dict[str, str]  # C sources and headers
    description: str
    component: type | None = None


def build(
    models: Iterable[Any] | Any,
    out_dir: str | Path,
    platforms: Iterable[str] | str = ("host",),
    jobs: int | None = None,
    progress: Progress | None = None,
    pictures: bool = True,
) -> list[Path]:
    """Build one FMU for each component class (or lowered model) and return their paths, in order.

    ``platforms`` are ``"host"``, ``"all"`` or platform names of FMI 2 or FMI 3. What has not changed is taken from the
    user's cache: a finished FMU when its sources are the same, else each library when its C code is.
    Without ``pictures`` there is no icon and no example run in the documentation; then nothing runs on this machine.
    """
    return [built.path for built in build_all(models, out_dir, platforms, jobs, progress, pictures=pictures)]


def build_all(
    models: Iterable[Any] | Any,
    out_dir: str | Path,
    platforms: Iterable[str] | str = ("host",),
    jobs: int | None = None,
    progress: Progress | None = None,
    twins: str | Path | None = None,
    pictures: bool = True,
) -> list[Built]:
    """Like :func:`build`, and say which FMUs were unchanged; with ``twins`` write the Python twins to that folder.

    A component that needs a Python package has that twin alone.
    """
    models = [models] if isinstance(models, ir.Model | type) else list(models)
    _check_names(models)
    out_dir, tuples = Path(out_dir), toolchain.resolve(platforms)
    toolchain.version()
    done: dict[tuple[int, str], Built] = {}
    waiting: list[tuple[int, Sources, dict[str, Future[Path]], str | None]] = []
    show = progress or (lambda done, total, note: None)
    total = len(models) * (2 if twins else 1)
    with ThreadPoolExecutor(jobs or os.cpu_count() or 1) as pool:
        try:
            for i, item in enumerate(models):
                component = None if isinstance(item, ir.Model) else item
                name = item.name if component is None else component.layout.name
                lowered: list[ir.Model] = [] if component else [item]
                show(len(done), total, f"tracing {name}")
                if twins and component:
                    done[i, "twin"] = _twin(component, lowered, Path(twins), pictures)
                if component and component.needs:
                    if not twins:
                        raise NavfmuError(
                            f"'{name}' calls the Python package {' and '.join(component.needs)} and has no native FMU; "
                            "expected a folder for Python twins, or build_twin"
                        )
                    continue
                key = fingerprint(component, "native", *_kind(pictures), *tuples) if component else None
                path = out_dir / f"{name}.fmu"
                if key and _take(key, path):
                    done[i, "native"] = Built(path, True)
                else:
                    lowered = lowered or [_lower(component)]
                    sources = prepare(lowered[0], component)
                    needed = dict.fromkeys([*tuples, toolchain.host()] if pictures else tuples)
                    futures = {platform: pool.submit(library, sources, platform) for platform in needed}
                    waiting.append((i, sources, futures, key))
            for i, sources, futures, key in waiting:
                while wait(futures.values(), timeout=0.5).not_done:
                    show(len(done), total, f"compiling {sources.model.name}")
                libraries = {platform: future.result() for platform, future in futures.items()}
                shown = None
                if pictures:
                    example = getattr(sources.component, "example", None)
                    shown = illustrate(sources.model, sources.guid, libraries[toolchain.host()], example)
                path = pack(sources, libraries, tuples, out_dir / f"{sources.model.name}.fmu", shown)
                _keep(key, path)
                done[i, "native"] = Built(path, False)
                show(len(done), total, sources.model.name)
        except BaseException:
            pool.shutdown(wait=False, cancel_futures=True)
            raise
    return [done[key] for key in sorted(done, key=lambda k: (k[1], k[0]))]


def _check_names(models: list[Any]) -> None:
    names: dict[str, Any] = {}
    for item in models:
        if not isinstance(item, ir.Model) and not hasattr(item, "layout"):
            raise NavfmuError(f"{item!r} is not a component; expected a subclass of navfmu.export.Component")
        name = item.name if isinstance(item, ir.Model) else item.layout.name
        if name in names:
            raise NavfmuError(f"two components are named '{name}': {names[name]!r} and {item!r}")
        names[name] = item


def _lower(component: type) -> ir.Model:
    from navfmu.export.tracing.lower import lower

    return lower(component)


def _kind(pictures: bool) -> list[str]:
    """Return what keeps FMUs with and without pictures apart in the cache."""
    return [] if pictures else ["without pictures"]


def _twin(component: type, lowered: list[ir.Model], folder: Path, pictures: bool) -> Built:
    from navfmu.export.twin import build_twin

    path = folder / f"{component.layout.name}.fmu"
    key = fingerprint(component, "twin", *_kind(pictures))
    if key and _take(key, path):
        return Built(path, True)
    if not lowered:
        lowered.append(_lower(component))
    build_twin(component, folder, model=lowered[0], pictures=pictures)
    _keep(key, path)
    return Built(path, False)


# ---- steps ----


def prepare(model: ir.Model, component: type | None = None) -> Sources:
    """Generate the C code and the description of a model; the GUID is a hash of all that the binary depends on."""
    runtime = {path.name: path.read_text(encoding="utf-8") for path in sorted(RUNTIME.glob("*.[ch]"))}
    runtime["life.h"] = life.header()
    units = (UNIT,)
    if model.through:
        runtime, units = runtime | model.through.files, (UNIT, model.through.unit)
    code = codegen.generate(model, archive.NO_GUID)
    xml = description.describe(model, archive.NO_GUID, sources=units)
    guid = archive.guid(
        code,
        xml,
        *(part for item in runtime.items() for part in item),
        " ".join(toolchain.FLAGS),
        toolchain.version(),
    )
    files = {"model.c": code.replace(archive.NO_GUID, guid), **runtime}
    return Sources(model, guid, units, files, xml.replace(archive.NO_GUID, guid), component)


def library(sources: Sources, platform: str) -> Path:
    """Return the compiled library for one platform, from the cache if it is there."""
    name = f"{sources.model.name}{toolchain.suffix(platform)}"
    digest = hashlib.sha256()
    for part in (*(p for item in sorted(sources.files.items()) for p in item), *toolchain.FLAGS, toolchain.version()):
        digest.update(part.encode() + b"\0")

    def fill(folder: Path) -> None:
        with tempfile.TemporaryDirectory(prefix="navfmu-", dir=folder.parent) as scratch:
            for file, text in sources.files.items():
                (Path(scratch) / file).write_text(text, encoding="utf-8", newline="\n")
            units = [Path(scratch) / unit for unit in sources.units]
            toolchain.compile_shared(units, folder / name, platform, include=[scratch])

    return cache.keep("compiled", f"{digest.hexdigest()[:32]}-{platform}", fill) / name


def pack(
    sources: Sources,
    libraries: dict[str, Path],
    platforms: Iterable[str],
    path: Path,
    shown: Illustration | None = None,
) -> Path:
    """Write the FMU with the libraries for ``platforms``, and what it is shown with."""
    model = sources.model
    run = shown.response if shown else None
    page = documentation.page(model, run, [sources.component] if sources.component else [])
    files: dict[str, bytes | str] = {
        "modelDescription.xml": sources.description,
        "documentation/index.html": page,
    }
    if shown:
        files["model.png"] = shown.icon
    files |= {f"documentation/licenses/{name}": text for name, text in _licenses().items()}
    files |= {f"sources/{name}": text for name, text in sources.files.items()}
    files |= {f"resources/{table.file}": table.content for table in model.tables}
    platforms = tuple(platforms)
    for platform in platforms:
        files[f"binaries/{archive.FOLDERS[platform]}/{libraries[platform].name}"] = libraries[platform].read_bytes()
    macs = [libraries[platform] for platform in ("x86_64-darwin", "aarch64-darwin") if platform in platforms]
    if macs:  # FMI 2.0 has one name for all macOS
        data = toolchain.universal([mac.read_bytes() for mac in macs]) if len(macs) > 1 else macs[0].read_bytes()
        files[f"binaries/darwin64/{macs[0].name}"] = data
    return archive.write(path, files)


def _licenses() -> dict[str, str]:
    texts = {file.name: file.read_text(encoding="utf-8") for file in sorted(LICENSES.glob("*.txt"))}
    package = importlib.util.find_spec("ziglang")
    mingw = Path(package.origin).parent / "lib" / "libc" / "mingw" / "COPYING"
    if mingw.is_file():
        texts["mingw-w64.txt"] = mingw.read_text(encoding="utf-8")
    return texts


# ---- cache ----


def _take(key: str, path: Path) -> bool:
    """Put the FMU with this key in its place, if the cache has it."""
    kept = cache.find("built", key)
    if kept is None:
        return False
    content = (kept / "built.fmu").read_bytes()
    if not (what_is(path) == "a file" and path.read_bytes() == content):
        write_file(path, content)
    return True


def _keep(key: str | None, path: Path) -> None:
    if key:
        cache.keep("built", key, lambda folder: shutil.copyfile(path, folder / "built.fmu"))
