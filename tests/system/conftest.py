"""The shipped system, packed once per session from this session's FMUs."""

import pytest

from navfmu import System
from system_ssp.backup_navigator.system import FMUS, source
from tests import built


@pytest.fixture(scope="session")
def fmus(tmp_path_factory):
    """Folder of the FMUs of all variants."""
    for name in FMUS:
        built.fmu(name, tmp_path_factory)
    return built.folder(tmp_path_factory)


@pytest.fixture(scope="session")
def package(fmus):
    """The packed system."""
    return source(fmus).pack(fmus / "backup_navigator.ssp")


@pytest.fixture(scope="session")
def load(package):
    """``load(variant=None)`` -> System, each loaded once."""
    loaded = {}

    def get(variant=None):
        if variant not in loaded:
            loaded[variant] = System.load(package, variant=variant)
        return loaded[variant]

    return get
