"""The engine and a test FMU under the address and undefined-behaviour sanitizers."""

from pathlib import Path

from navfmu.engine.library import RUNTIME, SOURCE, UNITS
from tests import sanitizers


@sanitizers.needs_gcc
def test_address_and_undefined_behaviour_sanitizers_find_nothing(tmp_path):
    include, shared = (SOURCE, RUNTIME), sanitizers.SHARED
    engine = sanitizers.compile(UNITS, tmp_path / "engine.so", include, *shared)
    probe = sanitizers.compile([Path(__file__).with_name("probe.c")], tmp_path / "probe.so", include, *shared)
    sanitizers.run_python("tests.engine.sanitized_run", engine, probe)
