"""The engine and a test FMU under the address and undefined-behaviour sanitizers."""

from pathlib import Path

from navfmu.engine.library import RUNTIME, SOURCE, UNITS
from tests import sanitizers


@sanitizers.needs_gcc
def test_address_and_undefined_behaviour_sanitizers_find_nothing(tmp_path):
    include, shared = (SOURCE, RUNTIME), sanitizers.SHARED
    engine = sanitizers.compile(UNITS, tmp_path / "engine.so", include, *shared)
    tests = Path(__file__).parents[1]
    probe, stepper = (
        sanitizers.compile([tests / f"{name}.c"], tmp_path / f"{Path(name).name}.so", include, *shared)
        for name in ("engine/probe", "foreign/stepper")
    )
    sanitizers.run_python("tests.engine.sanitized_run", engine, probe, stepper)
