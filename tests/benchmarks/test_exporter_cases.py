"""What is compared with the exporter's code does the same work, and the work is right: loops in C, forms in NumPy."""

from __future__ import annotations

import numpy as np
import pytest

from benchmarks.exporter import by_elements, error_states, satellites
from benchmarks.exporter.cases import STATES_DRIVEN, cases
from benchmarks.exporter.contests import flat
from benchmarks.exporter.loops import Loops
from benchmarks.exporter.translated import Translated
from models.filters import kalman, kalman_ud
from navfmu.export import toolchain

CASES = {case.name: case for case in cases() if case.states == 15}
MOTION = 0.01, np.array([0.5, -0.3, -9.8]), np.array([[0.6, 0.0, 0.8], [0.0, 1.0, 0.0], [-0.8, 0.0, 0.6]]), 0.99, 0.98


@pytest.fixture(scope="module")
def loops(tmp_path_factory):
    return Loops(15, STATES_DRIVEN[15], tmp_path_factory.mktemp("loops"))


@pytest.mark.parametrize("name", CASES)
def test_loops_in_c_give_what_numpy_gives(loops, name):
    """Catches a peer that is fast because it leaves something out."""
    case = CASES[name]
    given = np.concatenate([np.ravel(np.asarray(argument, float)) for argument in case.arguments])
    for function in case.forms.values():
        expected = flat(function)(*case.arguments)
        watch = loops.stopwatch(loops.address(case.loops), given, expected.size)
        np.testing.assert_allclose(watch.result, expected, rtol=1e-12, atol=1e-14)


def test_the_exporter_gives_what_numpy_gives(loops, tmp_path, monkeypatch):
    host = toolchain.host()
    monkeypatch.setattr(toolchain, "TARGETS", {host: toolchain.TARGETS[host]})
    case = next(case for name, case in CASES.items() if "U-D" in name and "update" in name)
    given = np.concatenate([np.ravel(np.asarray(argument, float)) for argument in case.arguments])
    for function in case.forms.values():
        expected = flat(function)(*case.arguments)
        made = Translated(flat(function), case.arguments, case.modules, tmp_path)
        watch = loops.stopwatch(made.address, given, expected.size)
        np.testing.assert_allclose(watch.result, expected, rtol=1e-12, atol=1e-14)
        assert made.to_compile.keys() == {host}


def test_blocks_are_the_matrix():
    """Phi = 1 + F T, written out with the matrix of the vector product; two sides of P."""
    period, force, c, gyro, accelerometer = MOTION
    x, y, z = force
    phi = np.eye(15)
    phi[0:3, 3:6] = period * np.eye(3)
    phi[3:6, 6:9] = period * np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    phi[3:6, 12:15] = period * c
    phi[6:9, 9:12] = -period * c
    phi[9:12, 9:12], phi[12:15, 12:15] = gyro * np.eye(3), accelerometer * np.eye(3)
    rng = np.random.default_rng(3)
    root, noise = rng.standard_normal((15, 18)), rng.uniform(0.1, 1.0, 15)
    p = root @ root.T
    predicted = kalman.unpack(error_states.predict(kalman.pack(p), noise, *MOTION))
    np.testing.assert_allclose(predicted, phi @ p @ phi.T + np.diag(noise), rtol=1e-12, atol=1e-12)


def test_a_bank_is_its_filters_one_by_one():
    case = next(case for name, case in CASES.items() if "bank" in name)
    corrections, uppers, noises, row, variances, residual, *motion = case.arguments
    x, p = error_states.bank(*case.arguments)
    for i in range(4):
        one = kalman.update(
            corrections[i], error_states.predict(uppers[i], noises[i], *motion), row, variances[i], residual
        )
        np.testing.assert_allclose(x[i], one[0], rtol=1e-14)
        np.testing.assert_allclose(p[i], one[1], rtol=1e-14)
    assert len({float(first[0]) for first in p}) == 4


@pytest.mark.parametrize("form", [kalman_ud, by_elements])
def test_both_ways_of_writing_are_the_matrix_filter(form):
    rng = np.random.default_rng(4)
    root = rng.standard_normal((6, 9))
    p, rows, factor, noise = root @ root.T, rng.standard_normal((4, 6)), np.array([0.9, 0.8]), rng.uniform(0.1, 1.0, 6)
    columns = form.propagate(kalman_ud.factors(p), rows, factor, noise)
    upper = kalman.propagate(kalman.pack(p), rows, factor, noise)
    np.testing.assert_allclose(kalman_ud.covariance(columns), kalman.unpack(upper), rtol=1e-12)
    row = rng.standard_normal(6)
    x, columns = form.update(np.ones(6), columns, row, 0.7, 2.0)[:2]
    right = kalman.update(np.ones(6), upper, row, 0.7, 2.0)
    np.testing.assert_allclose(x, right[0], rtol=1e-12)
    np.testing.assert_allclose(kalman_ud.covariance(columns), kalman.unpack(right[1]), rtol=1e-11, atol=1e-12)


def test_a_fix_from_exact_ranges_is_where_the_receiver_is():
    """And so is the fix of equations that are solved by the library."""
    case = next(case for name, case in CASES.items() if "satellites" in name)
    _, positions, _, weights = case.arguments
    true = np.array([1234.0, -567.0, 89.0, 4321.0])
    ranges = np.linalg.norm(positions - true[:3], axis=1) + true[3]
    for solve in (satellites.solve_by_library, satellites.solve_written_out):
        np.testing.assert_allclose(satellites.fix(np.zeros(4), positions, ranges, weights, solve), true, atol=1e-6)
