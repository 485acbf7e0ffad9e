"""docs/testing.md shows what is seen."""

from __future__ import annotations

import ast
import io
import re

import pytest
from matplotlib.image import imread

from system_ssp.backup_navigator.system import FMUS, source
from tests import built
from tools import testing_page


@pytest.fixture(scope="module")
def seen(tmp_path_factory):
    """The page's example, run on the system as it is built now."""
    for name in FMUS:
        built.fmu(name, tmp_path_factory)
    folder = tmp_path_factory.mktemp("page")
    source(built.folder(tmp_path_factory)).write(folder / "backup_navigator")
    return testing_page.run(folder)


def test_the_page_shows_what_is_seen(seen):
    assert testing_page.shown() == seen.text, "python -m tools.testing_page writes it anew"


def test_the_picture_is_that_of_the_run(seen):
    there, made = imread(testing_page.PICTURE), imread(io.BytesIO(seen.plot))
    assert there.shape == made.shape
    assert abs(there - made).mean() < 0.01  # letters may differ by a pixel


def test_every_example_of_the_page_is_python_and_every_name_is_one():
    from navfmu.system.experiment import Experiment
    from navfmu.testing.bench import FINDINGS, Bench
    from navfmu.testing.marks import MARKS

    text = testing_page.PAGE.read_text()
    for example in re.findall(r"```python\n(.*?)```", text, re.DOTALL):
        ast.parse(example)
    for name in re.findall(r"`s\.(\w+)", text):
        assert hasattr(Bench, name) or name in ("parameters", "system"), name
    assert set(re.findall(r"pytest\.mark\.(\w+)", text)) == set(MARKS)
    assert set(re.findall(r"\(`(\w+)`[;)]", text)) == set(FINDINGS)
    for name in ("stop", "step", "seed", "algorithm", "record", "record_period", "engine"):
        assert f"`{name}`" in text and name in Experiment.__dataclass_fields__
