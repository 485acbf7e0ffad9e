"""Masters and importers that this project did not write, behind one face: outputs of every component after N steps.

What had to be learnt about each, found by running them:

FMPy 0.3
    ``simulate_ssp`` loses initial output values on the first exchange and makes one step too many; it is not used.
libcosim 0.0.6
    Counts time in nanoseconds. Unpacks FMUs by GUID, so two FMUs with one GUID are one FMU. Its bindings check little:
    the answer of every call is asserted here.
Ecos 0.7
    The wheel's ``ecos`` program is not executable as installed; it adds up its time, so that a step of 0.1 s gives one
    step more than expected (a power of two does not); its CSV has six decimals. The same library is reached from Python
    with full numbers. Without the name of a parameter set it applies none, silently.
"""

from __future__ import annotations

import os
import shutil
import stat
import subprocess
from pathlib import Path

import fmpy
import pytest

from navfmu.ssp.document import PARAMETER_SET

READ = {"Real": "real", "Integer": "integer", "Boolean": "boolean"}
VALUES = dict[str, float]


def require(condition: bool, what: str) -> None:
    """Fail on CI, where everything is installed; elsewhere skip with the reason."""
    if condition:
        return
    if os.environ.get("CI"):
        pytest.fail(f"{what} is missing; .ci/run installs it")
    pytest.skip(f"{what} is not installed on this machine (see .ci/run)")


def outputs(fmu: str | Path) -> list:
    """Output variables of an FMU, from FMPy's reader."""
    description = fmpy.read_model_description(str(fmu), validate=False)
    return [v for v in description.modelVariables if v.causality == "output" and v.type in READ]


def starts(fmu: str | Path) -> dict[str, float]:
    """Values for the inputs of an FMU that make it do something: somewhere in flight, all measurements new."""
    chosen = {}
    description = fmpy.read_model_description(str(fmu), validate=False)
    flight = {
        "latitude": 0.655,
        "longitude": -2.127,
        "altitude": 900.0,
        "roll": 0.1,
        "pitch": 0.02,
        "heading": 0.7,
        "true_airspeed": 50.0,
        "calibrated_airspeed": 48.0,
        "pressure_altitude": 905.0,
        "sequence": 1,
        "valid": True,
        "slant_range": 20000.0,
        "measured": True,
    }
    vectors = {
        "velocity_n": (40.0, 25.0, -1.0),
        "wind_n": (6.0, -3.0, 0.0),
        "specific_force": (0.4, -0.1, -9.8),
        "rate": (0.01, -0.02, 0.03),
        "field_b": (2.2e-5, 5e-6, 4.2e-5),
    }
    for variable in description.modelVariables:
        if variable.causality != "input":
            continue
        base, _, index = variable.name.split(".")[-1].partition("[")
        if base in vectors:
            chosen[variable.name] = vectors[base][int(index.rstrip("]")) - 1]
        elif base in flight:
            chosen[variable.name] = flight[base]
    return chosen


# -- one FMU ---------------------------------------------------------------------------------------------------------


def fmpy_single(fmu: Path, step: float, steps: int, start: VALUES) -> VALUES:
    names = [v.name for v in outputs(fmu)]
    result = fmpy.simulate_fmu(
        str(fmu), stop_time=steps * step, output_interval=step, step_size=step, start_values=start, output=names
    )
    assert len(result) == steps + 1
    return {name: float(result[name][-1]) for name in names}


def libcosim_single(fmu: Path, step: float, steps: int, start: VALUES) -> VALUES:
    execution = _cosim_empty(step)
    return _cosim_run(execution, {"it": (_cosim_add(execution, fmu, "it", start), fmu)}, steps)["it"]


def ecos_library_single(fmu: Path, step: float, steps: int, start: VALUES) -> VALUES:
    ecospy = ecos_library()
    with ecospy.EcosSimulationStructure() as structure:
        structure.add_model("it", str(fmu))
        simulation = ecospy.EcosSimulation(structure=structure, step_size=step)
    try:
        _ecos_set(simulation, fmu, "it", start)
        return _ecos_run(simulation, {"it": fmu}, steps)["it"]
    finally:
        simulation.terminate()
        simulation.free()


def ecos_program(tmp_path: Path) -> Path:
    """An executable copy of the ``ecos`` program of the installed wheel."""
    import ecospy

    program = tmp_path / "ecos"
    if not program.exists():
        shutil.copy(Path(ecospy.__file__).parent / "binaries" / "ecos", program)
        program.chmod(program.stat().st_mode | stat.S_IXUSR)
    return program


def ecos_program_run(path: Path, step: float, steps: int, tmp_path: Path) -> dict[str, VALUES]:
    """Outputs by component as the ``ecos`` program writes them into its CSV file: six decimals."""
    finished = subprocess.run(
        [
            ecos_program(tmp_path),
            "simulate",
            "--path",
            path,
            "--stopTime",
            repr(steps * step),
            "--stepSize",
            repr(step),
            *(["--parameterSet", PARAMETER_SET] if path.suffix == ".ssp" else []),
        ],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        timeout=120,
    )
    assert finished.returncode == 0, finished.stdout + finished.stderr
    lines = (tmp_path / f"{path.stem}.csv").read_text().splitlines()
    header, *rows = [line.split(", ") for line in lines]  # names such as "a[1,2]" are not quoted
    assert int(rows[-1][0]) == steps
    values: dict[str, VALUES] = {}
    for column, cell in zip(header[2:], rows[-1][2:], strict=True):
        instance, _, name = column.partition("::")
        values.setdefault(instance, {})[name.rsplit("[", 1)[0]] = float(cell)
    return values


# -- a system --------------------------------------------------------------------------------------------------------


def libcosim_ssp(folder: Path, fmus: dict[str, Path], step: float, steps: int) -> dict[str, VALUES]:
    """Run an unpacked SSP; ``fmus`` are its components."""
    from libcosimpy.CosimExecution import CosimExecution

    _cosim_quiet()
    execution = CosimExecution.from_ssp_file(str(folder), step_size=round(step * 1e9))
    slaves = {name: (execution.slave_index_from_instance_name(name), fmu) for name, fmu in fmus.items()}
    return _cosim_run(execution, slaves, steps)


def ecos_library_ssp(ssp: Path, fmus: dict[str, Path], step: float, steps: int) -> dict[str, VALUES]:
    simulation = ecos_library().EcosSimulation(ssp_path=str(ssp), step_size=step)
    try:
        return _ecos_run(simulation, fmus, steps, PARAMETER_SET)
    finally:
        simulation.terminate()
        simulation.free()


# -- libcosim --------------------------------------------------------------------------------------------------------


def _cosim_quiet() -> None:
    from libcosimpy.CosimLogging import CosimLogLevel, log_output_level

    log_output_level(CosimLogLevel.WARNING)


def _cosim_empty(step: float):
    from libcosimpy.CosimExecution import CosimExecution

    _cosim_quiet()
    return CosimExecution.from_step_size(round(step * 1e9))


def _cosim_add(execution, fmu: Path, name: str, start: VALUES) -> int:
    from libcosimpy.CosimSlave import CosimLocalSlave

    index = execution.add_local_slave(CosimLocalSlave(str(fmu), name))
    assert index >= 0
    variables = {v.name: v for v in fmpy.read_model_description(str(fmu), validate=False).modelVariables}
    for variable_name, value in start.items():
        variable = variables[variable_name]
        setter = getattr(execution, f"{READ[variable.type]}_initial_value")
        assert setter(index, variable.valueReference, _typed(variable, value))
    return index


def _cosim_run(execution, slaves: dict[str, tuple[int, Path]], steps: int) -> dict[str, VALUES]:
    from libcosimpy.CosimObserver import CosimObserver

    observer = CosimObserver.create_last_value()
    assert execution.add_observer(observer)
    assert execution.step(steps)
    values: dict[str, VALUES] = {}
    for name, (index, fmu) in slaves.items():
        values[name] = {}
        for kind in READ:
            chosen = [v for v in outputs(fmu) if v.type == kind]
            read = getattr(observer, f"last_{READ[kind]}_values")
            if chosen:
                numbers = read(index, [v.valueReference for v in chosen])
                values[name] |= {v.name: float(n) for v, n in zip(chosen, numbers, strict=True)}
    return values


# -- Ecos ------------------------------------------------------------------------------------------------------------


def ecos_library():
    """The module ``ecospy``; its library needs libtbb12 of the system."""
    try:
        import ecospy
    except OSError as problem:
        require(False, f"the library that ecospy needs ({problem})")
    ecospy.EcosLib.set_log_level("warn")
    return ecospy


def _ecos_set(simulation, fmu: Path, name: str, start: VALUES) -> None:
    setters = {"Real": simulation.set_real, "Integer": simulation.set_integer, "Boolean": simulation.set_bool}
    variables = {v.name: v for v in fmpy.read_model_description(str(fmu), validate=False).modelVariables}
    for variable_name, value in start.items():
        variable = variables[variable_name]
        setters[variable.type](f"{name}::{variable_name}", _typed(variable, value))


def _ecos_run(simulation, fmus: dict[str, Path], steps: int, parameter_set: str | None = None) -> dict[str, VALUES]:
    assert simulation.init(parameter_set=parameter_set)
    simulation.step(steps)
    getters = {"Real": simulation.get_real, "Integer": simulation.get_integer, "Boolean": simulation.get_bool}
    return {
        name: {v.name: float(getters[v.type](f"{name}::{v.name}")) for v in outputs(fmu)} for name, fmu in fmus.items()
    }


def _typed(variable, value: float):
    return {"Real": float, "Integer": int, "Boolean": bool}[variable.type](value)
