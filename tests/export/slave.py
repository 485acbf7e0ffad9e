"""An FMU through its bare C interface: every call returns its status, every message is kept."""

from __future__ import annotations

import ctypes
import zipfile
from pathlib import Path
from xml.etree import ElementTree

OK, WARNING, DISCARD, ERROR = 0, 1, 2, 3
_C = {"Real": ctypes.c_double, "Integer": ctypes.c_int, "Boolean": ctypes.c_int, "String": ctypes.c_char_p}
_LOGGER = ctypes.CFUNCTYPE(None, ctypes.c_void_p, ctypes.c_char_p, ctypes.c_int, ctypes.c_char_p, ctypes.c_char_p)


class Unzipped:
    """An FMU on disk, its description and its library."""

    def __init__(self, path: Path, folder: Path) -> None:
        with zipfile.ZipFile(path) as archive:
            archive.extractall(folder)
        self.folder = folder
        self.xml = ElementTree.parse(folder / "modelDescription.xml").getroot()
        self.name, self.guid = self.xml.get("modelName"), self.xml.get("guid")
        self.variables = {v.get("name"): v for v in self.xml.iter("ScalarVariable")}
        self.library = ctypes.CDLL(str(folder / "binaries" / "linux64" / f"{self.name}.so"))
        self.library.fmi2Instantiate.restype = ctypes.c_void_p
        for kind in ("Version", "TypesPlatform"):
            getattr(self.library, f"fmi2Get{kind}").restype = ctypes.c_char_p

    def reference(self, name: str) -> int:
        return int(self.variables[name].get("valueReference"))

    def type(self, name: str) -> str:
        tag = next(child.tag for child in self.variables[name] if child.tag in (*_C, "Enumeration"))
        return "Integer" if tag == "Enumeration" else tag


class Slave:
    """One instance."""

    def __init__(self, fmu: Unzipped, *, guid=None, name=b"tested", kind=1, resources=None, logging=0) -> None:
        self.fmu, self.messages = fmu, []
        self.logger = _LOGGER(self._log)
        self.callbacks = (ctypes.c_void_p * 5)(ctypes.cast(self.logger, ctypes.c_void_p))
        uri = (fmu.folder / "resources").as_uri() if resources is None else resources
        component = fmu.library.fmi2Instantiate(
            name,
            kind,
            (guid or fmu.guid).encode(),
            uri.encode(),
            ctypes.byref(self.callbacks),
            0,
            logging,
        )
        self.component = ctypes.c_void_p(component)

    def _log(self, environment, name, status, category, message):
        self.messages.append((status, (category or b"").decode(), message.decode()))  # PythonFMU gives none

    @property
    def said(self) -> str:
        """The last message."""
        return self.messages[-1][2] if self.messages else ""

    def call(self, function: str, *arguments) -> int:
        return getattr(self.fmu.library, f"fmi2{function}")(self.component, *arguments)

    def initialise(self, start=0.0, stop=None, **values) -> int:
        for name, value in values.items():
            assert self.set(name, value) == OK, self.said
        real = ctypes.c_double
        self.call("SetupExperiment", 0, real(0), real(start), int(stop is not None), real(stop or 0))
        self.call("EnterInitializationMode")
        return self.call("ExitInitializationMode")

    def step(self, time: float, h: float) -> int:
        return self.call("DoStep", ctypes.c_double(time), ctypes.c_double(h), 1)

    def set(self, name: str, value, kind: str | None = None) -> int:
        """Set one variable, or a whole array by its name without index."""
        kind = kind or self.fmu.type(self._names(name)[0])
        values = [value] if isinstance(value, str) or not hasattr(value, "__len__") else list(value)
        return self.set_references(kind, [self.fmu.reference(n) for n in self._names(name)], values)

    def set_references(self, kind: str, references: list[int], values: list) -> int:
        n = len(references)
        values = [value.encode() if isinstance(value, str) else value for value in values]
        numbers, data = (ctypes.c_uint * n)(*references), (_C[kind] * n)(*values)
        return self.call(f"Set{kind}", numbers, ctypes.c_size_t(n), data)

    def get_references(self, kind: str, references: list[int]) -> tuple[int, list]:
        n = len(references)
        data = (_C[kind] * n)()
        status = self.call(f"Get{kind}", (ctypes.c_uint * n)(*references), ctypes.c_size_t(n), data)
        if kind == "String":
            return status, [text.decode() if text is not None else None for text in data]
        return status, list(data)

    def get(self, name: str):
        names = self._names(name)
        kind = self.fmu.type(names[0])
        status, values = self.get_references(kind, [self.fmu.reference(n) for n in names])
        assert status == OK, self.said
        return values if names[0] != name else values[0]

    def derivative(self, name: str, value: float, order: int = 1) -> int:
        one = ctypes.c_size_t(1)
        reference, number = (ctypes.c_uint * 1)(self.fmu.reference(name)), (ctypes.c_double * 1)(value)
        return self.call("SetRealInputDerivatives", reference, one, (ctypes.c_int * 1)(order), number)

    def everything(self) -> list:
        """All values of all variables."""
        return [self.get(name) for name in self.fmu.variables]

    def save(self) -> ctypes.c_void_p:
        state = ctypes.c_void_p()
        assert self.call("GetFMUstate", ctypes.byref(state)) == OK
        return state

    def serialise(self, state: ctypes.c_void_p) -> bytes:
        size = ctypes.c_size_t()
        assert self.call("SerializedFMUstateSize", state, ctypes.byref(size)) == OK
        buffer = ctypes.create_string_buffer(size.value)
        assert self.call("SerializeFMUstate", state, buffer, size) == OK
        return buffer.raw

    def deserialise(self, data: bytes) -> tuple[int, ctypes.c_void_p]:
        state = ctypes.c_void_p()
        return self.call("DeSerializeFMUstate", data, ctypes.c_size_t(len(data)), ctypes.byref(state)), state

    def free(self) -> None:
        self.call("FreeInstance")

    def _names(self, name: str) -> list[str]:
        if name in self.fmu.variables:
            return [name]
        return [n for n in self.fmu.variables if n.startswith(f"{name}[")]
