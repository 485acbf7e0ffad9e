"""Files that are cut off anywhere, or damaged: a sentence, or what is left of them; never another exception."""

import numpy as np
import pytest

from navfmu.errors import NavfmuError
from navfmu.satellite.file import read_orbits
from navfmu.satellite.observations import read_observations
from tests.satellite import made
from tests.satellite.test_orbits import NEAR

FILES = {
    "navigation 2": made.navigation_2(made.REMONDI, made.GLAB),
    "navigation 3": made.navigation_3(made.GLONASS, made.REMONDI, made.GLAB),
    "yuma": made.yuma(1, 2, 3),
    "sem": made.sem(1, 2, 3),
    "observations 2": made.OBSERVED_2,
    "observations 3": made.OBSERVED_3,
}


def numbers(path):
    """All numbers of a file, or None if it is refused; the sentences of what is read."""
    try:
        if "OBSERVATION" in path.read_text("latin1")[:80]:
            found = read_observations(path)
            return np.concatenate(
                [found.second, *(value.ravel() for value in found.values.values())]
            ), found.sentences()
        found = read_orbits(path, NEAR)
        return found.rows.ravel(), found.sentences()
    except NavfmuError as error:
        assert str(path) in str(error)
        return None, [str(error)]


@pytest.mark.parametrize("name", FILES)
def test_cut_off_anywhere(tmp_path, name):
    """What is read of the rest are numbers of the whole file, none of them shortened; a line without an end is told.

    Only when a message was sent may be unknown, where its last line is cut: then two hours before t_oe are taken.
    """
    whole, _ = numbers(made.written(tmp_path, "whole", FILES[name]))
    known, refused = {*whole[np.isfinite(whole)].tolist(), 86400.0, 165600.0}, 0
    for length in range(1, len(FILES[name]), 5):
        text = FILES[name][:length]
        found, told = numbers(made.written(tmp_path, "cut", text))
        refused += found is None
        if found is not None:
            assert set(found[np.isfinite(found)].tolist()) <= known, (length, told)
            assert text.endswith("\n") or any("may be cut off" in sentence for sentence in told), length
    assert refused > 0.8 * len(FILES[name]) / 5


@pytest.mark.parametrize("name", FILES)
def test_damaged_anywhere(tmp_path, name):
    """A character that is another one, a line that is gone or moved: 300 files of each kind."""
    random = np.random.default_rng(8)
    text, lines = FILES[name], FILES[name].splitlines(keepends=True)
    for k in range(300):
        if k % 3:
            at = random.integers(len(text))
            damaged = text[:at] + random.choice(list(" 0123456789.-+DEXG\n>\0\xff")) + text[at + 1 :]
        else:
            moved = list(lines)
            moved.insert(random.integers(len(moved)), moved.pop(random.integers(len(moved))))
            damaged = "".join(moved[: len(moved) - k % 2])
        numbers(made.written(tmp_path, "damaged", damaged))
