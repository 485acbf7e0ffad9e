"""From components to .fmu files: trace, generate, compile for each platform, document, pack; each once."""

from __future__ import annotations

import hashlib
import os
import sys
import tempfile
from collections.abc import Callable, Iterable
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from navfmu.export import archive, codegen, description, ir, toolchain

RUNTIME = Path(__file__).parent / "runtime"
_NO_GUID = "{00000000-0000-0000-0000-000000000000}"


@dataclass
class Sources:
    """What one FMU is made of, before it is compiled."""

    model: ir.Model
    guid: str
    files: dict[str, str]  # C sources and headers
    description: str


def build(
    models: Iterable[Any] | Any,
    out_dir: str | Path,
    platforms: Iterable[str] | str = ("host",),
    jobs: int | None = None,
    progress: Callable[[str], None] | None = None,
) -> list[Path]:
    """Build one FMU for each component class (or lowered model) and return their paths, in order.

    ``platforms`` are ``"host"``, ``"all"`` or platform names. What has not changed is taken from the cache
    (:func:`cache_folder`): a finished FMU when its sources are the same, else each library when its C code is.
    """
    if isinstance(models, ir.Model | type):
        models = [models]
    models, out_dir = list(models), Path(out_dir)
    tuples = toolchain.resolve(platforms)
    say = progress or (lambda text: None)
    paths: list[Path] = []
    with ThreadPoolExecutor(jobs or os.cpu_count() or 1) as pool:
        started: list[tuple[Sources, dict[str, Future[Path]]]] = []
        for item in models:
            model = _lower(item)
            say(f"{model.name}: traced")
            sources = prepare(model)
            started.append((sources, {p: pool.submit(library, sources, p) for p in tuples}))
        for sources, futures in started:
            libraries = {platform: future.result() for platform, future in futures.items()}
            paths.append(pack(sources, libraries, out_dir / f"{sources.model.name}.fmu"))
            say(f"{sources.model.name}: {paths[-1]}")
    return paths


def _lower(item: Any) -> ir.Model:
    if isinstance(item, ir.Model):
        return item
    from navfmu.export.lower import lower

    return lower(item)


def prepare(model: ir.Model) -> Sources:
    """Generate the C code and the description of a model; the GUID is a hash of all that the binary depends on."""
    runtime = {path.name: path.read_text() for path in sorted(RUNTIME.glob("*.[ch]"))}
    compiled = ["fmu.c"]  # it includes the others
    guid = archive.guid(
        codegen.generate(model, _NO_GUID),
        description.describe(model, _NO_GUID, sources=compiled),
        *(part for item in runtime.items() for part in item),
        " ".join(toolchain.FLAGS),
        toolchain.version(),
    )
    files = {"model.c": codegen.generate(model, guid), **runtime}
    return Sources(model, guid, files, description.describe(model, guid, sources=compiled))


def library(sources: Sources, platform: str) -> Path:
    """Return the compiled library for one platform, from the cache if it is there."""
    name = f"{sources.model.name}{toolchain.suffix(platform)}"
    digest = hashlib.sha256()
    for part in (*(p for item in sorted(sources.files.items()) for p in item), *toolchain.FLAGS, toolchain.version()):
        digest.update(part.encode() + b"\0")
    path = cache_folder() / "libraries" / digest.hexdigest()[:32] / platform / name
    if not path.is_file():
        path.parent.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory(prefix="navfmu-") as scratch:
            for file, text in sources.files.items():
                (Path(scratch) / file).write_text(text)
            toolchain.compile_shared([Path(scratch) / "fmu.c"], path, platform, include=[scratch])
    return path


def pack(sources: Sources, libraries: dict[str, Path], path: Path) -> Path:
    """Write the FMU."""
    model = sources.model
    files: dict[str, bytes | str] = {"modelDescription.xml": sources.description, "model.png": archive.icon(model.name)}
    files |= {f"sources/{name}": text for name, text in sources.files.items()}
    files |= {f"resources/{table.name}.csv": codegen.table_text(table) for table in model.tables}
    for platform, library_path in libraries.items():
        files[f"binaries/{archive.FOLDERS[platform]}/{library_path.name}"] = library_path.read_bytes()
    return archive.write(path, files)


def cache_folder() -> Path:
    """Return the folder of the cache: ``$NAVFMU_CACHE`` or ``navfmu`` in the user's cache folder."""
    if chosen := os.environ.get("NAVFMU_CACHE"):
        return Path(chosen)
    if sys.platform == "win32":
        base = Path(os.environ.get("LOCALAPPDATA", Path.home()))
    elif sys.platform == "darwin":
        base = Path.home() / "Library" / "Caches"
    else:
        base = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache")
    return base / "navfmu"
