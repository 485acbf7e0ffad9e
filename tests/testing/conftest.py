import pytest

from tests.testing.inner import Folder


@pytest.fixture
def folder(tmp_path):
    return Folder(tmp_path / "a folder")
