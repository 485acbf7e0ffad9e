"""The random numbers are Philox4x64-10, and normal."""

import numpy as np
import pytest
from scipy import stats

from navfmu.export.noise import Normals, philox, uniform

ONES = 2**64 - 1
#: Known-answer vectors published with Random123 (kat_vectors: philox 4x64, 10 rounds): counter, key, result.
KNOWN = [
    (
        (0, 0, 0, 0),
        (0, 0),
        (0x16554D9ECA36314C, 0xDB20FE9D672D0FDC, 0xD7E772CEE186176B, 0x7E68B68AEC7BA23B),
    ),
    (
        (ONES, ONES, ONES, ONES),
        (ONES, ONES),
        (0x87B092C3013FE90B, 0x438C3C67BE8D0224, 0x9CC7D7C69CD777B6, 0xA09CAEBF594F0BA0),
    ),
    (
        (0x243F6A8885A308D3, 0x13198A2E03707344, 0xA4093822299F31D0, 0x082EFA98EC4E6C89),
        (0x452821E638D01377, 0xBE5466CF34E90C6C),
        (0xA528F45403E61D95, 0x38C72DBD566E9788, 0xA5A1610E72FD18B5, 0x57BD43B5E52B7FE6),
    ),
]


@pytest.mark.parametrize("counter, key, result", KNOWN)
def test_philox_gives_the_published_vectors(counter, key, result):
    assert philox(counter, key) == result


def test_philox_equals_numpys():
    rng = np.random.default_rng(1)
    for _ in range(20):
        counter = rng.integers(1, 2**63, 4, dtype=np.uint64)
        key = rng.integers(0, 2**63, 2, dtype=np.uint64)
        before = counter.copy()
        before[0] -= np.uint64(1)  # NumPy counts up before its first block
        expected = np.random.Philox(counter=before, key=key).random_raw(4)
        assert philox(tuple(map(int, counter)), tuple(map(int, key))) == tuple(map(int, expected))


def test_uniform_is_never_0_so_that_its_logarithm_is_finite():
    assert 0.0 < uniform(0) < 1e-16
    assert 1.0 - 1e-15 < uniform(ONES) <= 1.0


def test_numbers_do_not_depend_on_how_they_are_drawn():
    once = Normals(7, 3, 12, 1)(11)
    draw = Normals(7, 3, 12, 1)
    np.testing.assert_array_equal(np.concatenate([draw(1), draw(5), draw(0), draw(5)]), once)


def test_every_part_of_the_key_and_counter_changes_the_numbers():
    base = (7, 3, 12, 1)
    first = Normals(*base)(4)
    for i in range(4):
        other = [n + (j == i) for j, n in enumerate(base)]
        assert not np.any(np.isin(Normals(*other)(4), first))


def test_numbers_are_standard_normal_and_uncorrelated():
    z = np.array([Normals(1, 2, k, 0)(6) for k in range(2000)])
    assert stats.kstest(z.ravel(), "norm").pvalue > 0.01
    np.testing.assert_allclose(np.corrcoef(z.T), np.eye(6), atol=4 / np.sqrt(2000))
