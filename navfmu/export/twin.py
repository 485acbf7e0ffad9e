"""The Python twin: the same component as a PythonFMU, for tests, for a debugger, and to see what native code gains.

PythonFMU's wrapper library loads ``resources/NAME_HASH.py`` into the host's Python. All FMUs of a process share that
Python, so whatever two FMUs import under one name exists once, for both. Therefore the twin is a single module with a
name of its own: it carries the sources of the model, the interpreter and the random numbers, and loads them under
names that nobody else uses. Its modelDescription.xml is ours (units, ranges, initial unknowns) and replaces the one
that PythonFMU would write.
"""

from __future__ import annotations

import hashlib
import importlib.metadata
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

from navfmu.errors import NavfmuError
from navfmu.export import archive, description, fingerprint, interpreter, life
from navfmu.export.declaration.component import Component
from navfmu.export.imports import imports
from navfmu.export.page.icon import icon
from navfmu.export.record import ir

_NO_NAME = "a_twin_without_a_name"  # stands in the module until its name, which has a hash of it, is known
_HEAD = '''"""Python twin of the component {name}: the model, its interpreter and its random numbers in one file.

Generated from the sources below; each is loaded under a name that no other FMU uses.
"""

# PythonFMU runs this text once more for each instance and drops a reference to globals() that it does not own.
globals().setdefault("_references", []).append(globals())

import sys as _sys

from pythonfmu import Fmi2Slave
from pythonfmu.enums import Fmi2Status

if "_SOURCES" not in globals():
    import builtins
    import linecache
    import sys
    import types

    _UNIQUE = _FOLDER = {unique!r}
    _SOURCES = {{}}
    _MODULES = {{}}
'''

_LOADER = '''

def _known(name):
    return name in _SOURCES or any(source.startswith(name + ".") for source in _SOURCES)


def _load(name):
    """Return a carried module, run when it is first asked for."""
    if name not in _MODULES:
        parent, _, leaf = name.rpartition(".")
        module = _MODULES[name] = types.ModuleType(_UNIQUE + "." + name)
        sys.modules[module.__name__] = module
        text = _SOURCES.get(name, "")
        module.__file__ = "/".join([_FOLDER, *name.split(".")]) + ".py"
        module.__builtins__ = dict(vars(builtins), __import__=_import)
        module._carried_as = name
        linecache.cache[module.__file__] = (len(text), None, text.splitlines(True), module.__file__)
        if parent:
            setattr(_load(parent), leaf, module)
        exec(compile(text, module.__file__, "exec"), vars(module))
    return _MODULES[name]


def _import(name, globals=None, locals=None, fromlist=(), level=0):
    """Import for the carried modules: of each other here, of NumPy and the standard library as usual."""
    if level:
        here = globals["_carried_as"]
        is_package = any(source.startswith(here + ".") for source in _SOURCES)
        parts = here.split(".")
        parts = parts[: len(parts) - level + is_package]
        name = ".".join([*parts, name] if name else parts)
    if not _known(name):
        return builtins.__import__(name, globals, locals, fromlist, 0)
    module = _load(name)
    for item in fromlist or ():
        if _known(name + "." + item):
            _load(name + "." + item)
    return module if fromlist else _load(name.partition(".")[0])


if "_INTERPRETER" not in globals():
    _INTERPRETER = _load("navfmu.export.interpreter").Interpreter
    _ERROR = _load("navfmu.errors").NavfmuError


def _component(resources):
    """Return the class; its modules find their data files in the resources."""
    global _FOLDER
    _FOLDER = f"{resources}/{_UNIQUE}"
    return getattr(_load({module!r}), {component!r})
'''

_LIVE = '''"""FMU {name} in Python: the class as it is in the process that runs it."""

# PythonFMU runs this text once more for each instance and drops a reference to globals() that it does not own.
globals().setdefault("_references", []).append(globals())

import importlib
import sys as _sys

from pythonfmu import Fmi2Slave
from pythonfmu.enums import Fmi2Status

_UNIQUE = {unique!r}
_INTERPRETER = importlib.import_module("navfmu.export.interpreter").Interpreter
_ERROR = importlib.import_module("navfmu.errors").NavfmuError


def _component(resources):
    return getattr(importlib.import_module({module!r}), {component!r})
'''

_SLAVE = '''

def _tell(self, error):
    """Tell on stderr what is refused: PythonFMU gives the reason only where the host asks for its log."""
    print(f"{self.instance_name}: {error}", file=_sys.stderr, flush=True)


def _told(function):
    """Tell what is refused.

    On any error it drops references that it drops once more when the instance is freed. So each is kept here twice:
    one to be dropped, one to stay.
    """

    def call(self, *arguments):
        try:
            return function(self, *arguments)
        except Exception as error:
            if isinstance(error, _ERROR):
                _tell(self, error)
            globals()["_references"] += 2 * [self, type(self), self.log_queue]
            raise

    return call


class {component}Slave(Fmi2Slave):
    """What PythonFMU calls; all behaviour is the interpreter's.

    PythonFMU knows two ways to refuse, and has no fmi2Error: a step is discarded, any other call is fatal.
    """

    log_categories = {categories!r}

    def __init__(self, **kwargs):
        super().__init__(**kwargs)
        self.modelName = {name!r}
        try:
            self.run = _INTERPRETER(_component(self.resources), _UNIQUE, self.resources)
        except _ERROR as error:
            _tell(self, error)
            raise

    @_told
    def setup_experiment(self, start_time, stop_time, tolerance):
        self.run.setup_experiment(start_time, stop_time)

    @_told
    def enter_initialization_mode(self):
        self.run.enter_initialization()

    @_told
    def exit_initialization_mode(self):
        self.run.exit_initialization()

    @_told
    def do_step(self, current_time, step_size):
        try:
            self.run.do_step(current_time, step_size)
            return True
        except _ERROR as error:
            self.log(str(error), Fmi2Status.error, "logStatusError")
            _tell(self, error)
            return False
        finally:
            for event in self.run.events:
                self.log(event, Fmi2Status.ok, "logEvents")
            self.run.events.clear()

    @_told
    def terminate(self):
        self.run.terminate()

    @_told
    def get_real(self, vrs):
        return self.run.get_values("Real", vrs)

    @_told
    def get_integer(self, vrs):
        return self.run.get_values("Integer", vrs)

    @_told
    def get_boolean(self, vrs):
        return self.run.get_values("Boolean", vrs)

    @_told
    def get_string(self, vrs):
        return self.run.get_values("String", vrs)

    @_told
    def set_real(self, vrs, values):
        self.run.set_values("Real", vrs, values)

    @_told
    def set_integer(self, vrs, values):
        self.run.set_values("Integer", vrs, values)

    @_told
    def set_boolean(self, vrs, values):
        self.run.set_values("Boolean", vrs, values)

    @_told
    def set_string(self, vrs, values):
        self.run.set_values("String", vrs, values)

    def _get_fmu_state(self):
        return self.run.get_state()

    @_told
    def _set_fmu_state(self, state):
        self.run.set_state(state)
'''


def _source(name: str) -> str | None:
    """Return the source of an imported module, None for NumPy and the standard library."""
    if name.partition(".")[0] in {"numpy", *sys.stdlib_module_names} - {"__main__"}:
        return None
    file = getattr(sys.modules.get(name), "__file__", None)
    if file is None or not file.endswith(".py"):
        return "" if name in sys.modules and file is None else None
    if {"site-packages", "dist-packages"} & set(Path(file).parts) and not name.startswith("navfmu"):
        raise NavfmuError(f"the Python twin carries models in plain NumPy only, and one imports '{name}' ({file})")
    return Path(file).read_text(encoding="utf-8")


def sources(component: type[Component]) -> dict[str, str]:
    """Return the sources that a twin carries: module name to text."""
    carried = {"navfmu": ""}  # the front door leads to the whole package, which is not carried
    _collect(carried, [interpreter.__name__], lambda name: name.startswith("navfmu"))
    _collect(
        carried,
        [component.__module__],
        lambda name: not name.startswith("navfmu.export") and name.partition(".")[0] not in component.needs,
    )
    return dict(sorted(carried.items()))


def _collect(carried: dict[str, str], waiting: list[str], wanted: Callable[[str], bool]) -> None:
    """Add the sources of the modules that are waiting and of all that they import."""
    while waiting:
        name = waiting.pop()
        text = _source(name) if name not in carried and wanted(name) else None
        if text is None:
            continue
        carried[name] = text
        waiting += sorted(imports(name, text))
        waiting += [name.rpartition(".")[0]] if "." in name else []


def data(component: type[Component]) -> dict[str, bytes]:
    """Return the data files that a twin carries: those beside the model's modules whose names stand in their text.

    They lie where the module that reads them seems to lie, ``models/`` for a module ``models.terrain``.
    """
    found: dict[str, bytes] = {}
    for name, file in fingerprint.sources(component.__module__).items():
        text, folder = file.read_text(encoding="utf-8"), "/".join(name.split(".")[:-1])
        for path in sorted(file.parent.iterdir()):
            if path.suffix.lower() in fingerprint.DATA and path.name in text:
                found[f"{folder}/{path.name}".lstrip("/")] = path.read_bytes()
    return found


def _literal(text: str) -> str:
    """Return a Python literal of the text, with its lines as they are where that is possible."""
    if "'''" in text or text.endswith(("'", "\\")) or "\r" in text or "\0" in text:
        return repr(text)
    return "r'''" + text + "'''"


def module_text(component: type[Component], unique: str, categories: dict[str, str], live: bool = False) -> str:
    """Return the source of the one module in the twin; one that is ``live`` imports the class and carries nothing."""
    layout = component.layout
    names = {"name": layout.name, "unique": unique, "component": component.__name__}
    names |= {"module": component.__module__, "categories": categories}
    if live:
        return _filled(_LIVE + _SLAVE, names)
    lines = [_HEAD.format(**names)]
    for name, text in sources(component).items():
        lines.append(f"    _SOURCES[{name!r}] = {_literal(text)}\n")
    return "".join(lines) + _filled(_LOADER + _SLAVE, names)


def _filled(text: str, values: dict[str, Any]) -> str:
    for key, value in values.items():
        text = text.replace("{" + key + "!r}", repr(value)).replace("{" + key + "}", str(value))
    return text


def _license() -> str:
    """Return the licence of PythonFMU, whose library and modules the twin contains."""
    files = importlib.metadata.files("pythonfmu") or []
    return next(file.read_text(encoding="utf-8") for file in files if file.name.upper().startswith("LICENSE"))


def _entries(component: type[Component], model: ir.Model, pictures: bool, live: bool) -> dict[str, bytes]:
    """Return the files of the archive: path to content."""
    import pythonfmu

    from navfmu.export.page import documentation

    if "<locals>" in component.__qualname__ or "." in component.__qualname__:
        raise NavfmuError(
            f"component {component.__qualname__} has a Python twin only if its class stands at the top of a module"
        )
    text = module_text(component, _NO_NAME, life.categories(), live)
    xml = description.describe(model, archive.NO_GUID, needs_execution_tool=True, can_interpolate_inputs=False)
    files = {} if live else data(component)
    parts = (part for name, content in files.items() for part in (name, hashlib.sha256(content).hexdigest()))
    guid = archive.guid(text, xml, pythonfmu.__version__, *parts)
    unique = f"{model.name}_{guid[1:-1].replace('-', '')[:16]}"
    installed = importlib.metadata.distribution("pythonfmu")  # the module may be that of a twin which has run
    folder = Path(str(installed.locate_file("pythonfmu")))
    entries = {
        "modelDescription.xml": xml.replace(archive.NO_GUID, guid).encode(),
        "documentation/index.html": documentation.page(model, None, [component], twin=True).encode(),
        "documentation/licenses/pythonfmu.txt": _license().encode(),
        "resources/slavemodule.txt": unique.encode(),
        f"resources/{unique}.py": text.replace(_NO_NAME, unique).encode(),
    }
    entries |= {f"resources/{unique}/{name}": content for name, content in files.items()}
    if pictures:
        entries["model.png"] = icon(model.name)
    for file in sorted(folder.glob("*.py")):
        entries[f"resources/pythonfmu/{file.name}"] = file.read_bytes()
    for file in sorted(folder.glob("resources/binaries/*/*")):
        if file.suffix in (".so", ".dll", ".dylib"):
            entries[f"binaries/{file.parent.name}/{model.name}{file.suffix}"] = file.read_bytes()
    return entries


def build_twin(
    component: type[Component],
    out_dir: str | Path,
    *,
    model: ir.Model | None = None,
    pictures: bool = True,
    live: bool = False,
) -> Path:
    """Write ``out_dir/NAME.fmu``, the PythonFMU twin of a component; the same inputs give the same bytes.

    ``model`` is the lowered component, if the caller has it already. Without ``pictures`` there is no icon. A ``live``
    one is for this process only: it runs the class itself, where a debugger finds it, and carries no sources.
    """
    if model is None:
        from navfmu.export.tracing.lower import lower

        model = lower(component)
    return archive.write(Path(out_dir) / f"{model.name}.fmu", _entries(component, model, pictures, live))
