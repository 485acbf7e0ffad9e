"""Searches in tables and grids: natively, in the interpreter and traced they find what NumPy and SciPy find."""

import math
import re

import numpy as np
import pytest
from scipy.interpolate import RegularGridInterpolator

from navfmu.derivatives import jacobian
from navfmu.errors import NavfmuError
from navfmu.export import Component, Grid, Input, Output, Parameter, Table, every, require
from navfmu.export.build import build
from navfmu.export.declaration.interpolation import bilinear, fraction, linear
from navfmu.export.interpreter import Interpreter
from navfmu.export.printing.codegen import generate
from navfmu.export.tracing.lower import lower

from .components import Searcher
from .slave import OK, Slave, Unzipped

TABLE, GROUND = Searcher.profile, Searcher.ground
NAMES = ("rows", "between", "by_index", "many", "corners", "ends", "surface", "along", "fixed")
ODD = (math.nan, math.inf, -math.inf, -0.0, 1e308, -1e308)
#: At rows, between, at both ends and far outside; in both directions.
PLACES = (-99.0, -4.0, -3.9, -1.0, 0.0, 0.5, 1.0, 1.25, 1.5, 2.0, 2.5, 3.0, 8.9, 9.0, 77.0, *ODD)


def expected_row(x):
    """The row at or before x by a walk from the first row on, and the next one."""
    row = 0
    for candidate in range(1, 4):
        if math.isnan(x) or TABLE.rows[candidate, 1] <= x:
            row = candidate
    return row


def points():
    generator = np.random.default_rng(3)
    yield from ((x, y) for x in PLACES for y in PLACES)
    yield from generator.uniform(-12.0, 12.0, (200, 2)).tolist()


@pytest.fixture(scope="module")
def runs(unzipped):
    """(x, y) -> what the native FMU and the interpreter give, one after the other in one run: so cursors move."""
    native, floats = Slave(unzipped["searcher"]), Interpreter(Searcher)
    native.initialise()
    floats.setup()
    found = []
    for k, (x, y) in enumerate(points()):
        assert native.set("x", [x, y, x - y]) == OK
        assert native.set("y", y) == OK
        floats.set("x", [x, y, x - y])
        floats.set("y", y)
        assert native.step(0.5 * k, 0.5) == OK
        with np.errstate(all="ignore"):
            floats.do_step(0.5 * k, 0.5)
        found.append(((x, y), *({n: np.ravel(run.get(n)) for n in NAMES} for run in (native, floats))))
    native.free()
    return found


def test_native_fmu_and_interpreter_agree_to_the_last_bit(runs):
    """A cursor that decided something, or NaN that found what was found last, would differ."""
    for point, native, floats in runs:
        for name in NAMES:
            np.testing.assert_array_equal(native[name], floats[name], err_msg=f"{name} at {point}")


def test_rows_are_those_of_a_walk(runs):
    for (x, y), native, _ in runs:
        for i, value in enumerate((x, y, x - y)):
            row = expected_row(value)
            rows = native["rows"].reshape(3, 8)[i]
            np.testing.assert_array_equal(rows, TABLE.rows[[row, row + 1]].ravel())


def test_interpolated_columns_are_those_of_numpy(runs):
    """np.interp holds the ends, too. Its slope is rounded before it is multiplied: a few units in the last place of the
    largest value, which is 9."""
    for (x, y), native, _ in runs:
        for i, value in enumerate((x, y, x - y)):
            between = native["between"].reshape(3, 4)[i]
            for column in range(4):
                wanted = np.interp(value, TABLE.rows[:, 1], TABLE.rows[:, column])
                np.testing.assert_allclose(between[column], wanted, rtol=0, atol=4 * np.spacing(9.0))
        wanted = np.interp(x - y, TABLE.rows[:, 0], TABLE.rows[:, 3])
        np.testing.assert_allclose(native["by_index"][0], wanted, rtol=0, atol=4 * np.spacing(9.0))
        with np.errstate(over="ignore"):
            doubled = 2.0 * np.array([x, y, x - y])
        wanted = np.interp(doubled, TABLE.rows[:, 1], TABLE.rows[:, 3])
        np.testing.assert_allclose(native["many"], wanted, rtol=0, atol=4 * np.spacing(9.0))


def test_what_is_found_at_a_row_is_that_row_to_the_last_bit(runs):
    """(1 - u) a + u b, or a + u (b - a) at u = 1, would be off by a rounding at the last row."""
    exact = {row[1]: row for row in TABLE.rows.tolist()}
    seen = [native["between"].reshape(3, 4)[0].tolist() == exact[x] for (x, _), native, _ in runs if x in exact]
    assert len(seen) > 100 and all(seen)


def test_bilinear_surfaces_are_those_of_scipy(runs):
    """SciPy adds four products of weights: some eight roundings of numbers up to 8."""
    north, east, *heights = GROUND.numbers
    scipy = [RegularGridInterpolator((north, east), height) for height in heights]
    compared = 0
    for (x, y), native, _ in runs:
        if math.isnan(x) or math.isnan(y):
            assert np.all(np.isnan(native["surface"]))
            continue
        inside = np.clip(x, north[0], north[-1]), np.clip(y, east[0], east[-1])
        for k in range(2):
            wanted = scipy[k](inside).item()
            np.testing.assert_allclose(native["surface"][k], wanted, rtol=0, atol=8 * np.spacing(8.0))
        compared += 1
    assert compared > 400


def test_a_cell_has_its_corners_in_order(runs):
    """Swapped axes show: the grid is no square, and no height stands twice beside another."""
    north, east, *heights = GROUND.numbers
    for (x, y), native, _ in runs:
        i = 2 if math.isnan(x) else min(max(int(np.sum(north <= x)) - 1, 0), 2)
        j = 1 if math.isnan(y) else min(max(int(np.sum(east <= y)) - 1, 0), 1)
        wanted = [[[height[i + a, j + b] for height in heights] for b in (0, 1)] for a in (0, 1)]
        np.testing.assert_array_equal(native["corners"], np.ravel(wanted))
        np.testing.assert_array_equal(native["ends"], [north[i], north[i + 1], east[j], east[j + 1]])


def test_cells_that_share_an_edge_meet_there():
    """A surface with a step between two cells would kick whatever flies over it."""
    for y in np.linspace(-4.0, 3.0, 29):
        for edge in (0.0, 2.0):
            values = []
            for x in (np.nextafter(edge, -9.0), edge, np.nextafter(edge, 9.0)):
                found = GROUND.look_up(0, x, y)
                corners = found[4:].reshape(2, 2, 2)
                values.append(bilinear(fraction(x, *found[:2]), fraction(y, *found[2:4]), corners))
            np.testing.assert_allclose(np.diff(values, axis=0), 0.0, atol=1e-14)


def test_a_plane_is_a_plane():
    """Closed form: 3 x - 2 y + 1, and x y, which is bilinear, too; swapped weights would bend the plane."""
    x, y = np.array([-2.0, 1.0, 7.0]), np.array([0.0, 0.5, 4.0, 5.0])
    plane = 3.0 * x[:, None] - 2.0 * y + 1.0
    grid = Grid(axes=(("x", "m", x), ("y", "m", y)), surfaces=(("plane", "m", plane), ("xy", "m", np.outer(x, y))))
    at = np.random.default_rng(5).uniform((-2.0, 0.0), (7.0, 5.0), (500, 2)).T
    found = grid.look_up(0, *at)
    assert found.shape == (500, grid.width)
    u, v = fraction(at[0], found[:, 0], found[:, 1]), fraction(at[1], found[:, 2], found[:, 3])
    z = bilinear(u, v, found[:, 4:].reshape(500, 2, 2, 2))
    np.testing.assert_allclose(z, np.stack([3.0 * at[0] - 2.0 * at[1] + 1.0, at[0] * at[1]], -1), rtol=0, atol=1e-13)


def test_parts_stay_at_the_ends_and_nan_stays_nan():
    assert fraction(np.array([-1.0, 0.0, 0.5, 2.0, -np.inf, np.inf]), 0.0, 2.0).tolist() == [0, 0, 0.25, 1, 0, 1]
    assert math.isnan(fraction(math.nan, 0.0, 2.0))
    assert math.isnan(linear(math.nan, 1.0, 1.0))
    assert linear(1.0, 0.1, 0.3) == 0.3 and linear(0.0, 0.1, 0.3) == 0.1


@pytest.mark.parametrize("rows", [2, 3, 1000])
def test_any_jump_from_any_place_finds_the_row(rows, tmp_path):
    """The steps that double pass both ends of the table; one that stopped too early or too late would miss the row.

    There are 24 searches, more than have a place of their own where they begin the next time.
    """

    class Jumping(Component):
        """Jumping."""

        x = Input(24, "m", description="where")
        sample_period = Parameter("s", start=1.0, description="period")
        table = Table(columns=(("x", "m"),), rows=np.arange(float(rows))[:, None])
        row = Output(24, "m", description="row")

        @every("sample_period")
        def look(self):
            self.row = self.table.around(x=self.x).row[:, 0]

    (file,) = build([Jumping], tmp_path, pictures=False)
    slave = Slave(Unzipped(file, tmp_path / "unzipped"))
    slave.initialise()
    generator = np.random.default_rng(rows)
    near = np.repeat(np.arange(-1, min(rows, 40)), 3)
    places = generator.permutation(np.concatenate([near, generator.integers(-9, rows + 9, 2000)]))
    up = np.arange(-2, rows + 2)
    columns = (up, up[::-1], *(np.resize(generator.permutation(places), len(up) + len(places)) for _ in range(22)))
    for k, where in enumerate(np.stack([np.resize(column, len(up) + len(places)) for column in columns], -1)):
        x = where + generator.choice([0.0, 0.5], 24)
        slave.set("x", x.tolist())
        slave.step(float(k), 1.0)
        np.testing.assert_array_equal(slave.get("row"), np.clip(np.floor(x), 0, rows - 2), err_msg=str(k))
    slave.free()


def test_what_is_looked_for_twice_is_searched_once_and_what_is_fixed_once_and_for_all():
    code = generate(lower(Searcher), "guid")
    task = code[code.index("void task_1(") : code.index("static const Variable")]
    # x[0], x[1], x[2] by x; one by index; three by scale x; the three points (x, y), of which one is also the cell
    assert len(re.findall(r"table_rows\(tables, 0, \d+, 1, 4,", task)) == 6
    assert len(re.findall(r"table_rows\(tables, 0, \d+, 0, 4,", task)) == 1
    assert len(re.findall(r"table_corners\(tables, 1, \d+, 2,", task)) == 3
    settled = code[code.index("void fixed_values(") : code.index("void task_0(")]
    assert settled.count("table_rows(") == 1 and settled.count("table_corners(") == 1


def interpolated(table, x):
    """A function of a module that is given the table itself."""
    return table.around(x=x).linear()


def weighed(row, next_row):
    """A function that is given rows, and is compiled once and called."""
    return row @ np.ones((4, 4)) @ next_row


def test_searches_in_a_task_whose_arrays_are_kept_whole(tmp_path):
    """Operations enough that the task is loops and calls of functions: the rows are arrays among others there."""

    class Heavy(Component):
        """Heavy."""

        x = Input(12, "m", description="x")
        sample_period = Parameter("s", start=1.0, description="period")
        profile = Table(columns=Searcher.profile.columns, rows=Searcher.profile.rows, key=("x", "index"))
        ground = Grid(axes=(("north", "m", [0, 1, 3]), ("east", "m", [0, 2])), surfaces=(("z", "m", np.eye(3)[:, :2]),))
        state = Output((40, 40), "1", description="a matrix")
        rows = Output((12, 8), "1", description="rows")
        rest = Output(4, "1", description="what functions make of them")

        @every("sample_period")
        def look(self):
            matrix = 0.5 * self.state @ self.state.T + np.eye(40)
            self.state = matrix / np.sum(matrix)
            here = self.profile.around(x=self.x)
            self.rows = np.concatenate([here.row, here.next_row], axis=1)
            (z,) = self.ground.around(north=self.x[0] + self.state[1, 1], east=self.x[1]).bilinear()
            several = [weighed(here.row[i], here.next_row[i]) for i in range(12)]
            self.rest = np.array([np.sum(np.array(several)), interpolated(self.profile, self.x[2])[3], z, here.part[4]])

    assert "for (int" in generate(lower(Heavy), "guid")
    (file,) = build([Heavy], tmp_path, pictures=False)
    native, floats = Slave(Unzipped(file, tmp_path / "unzipped")), Interpreter(Heavy)
    native.initialise()
    floats.setup()
    for k, x in enumerate(np.random.default_rng(2).uniform(-6.0, 11.0, (50, 12))):
        native.set("x", x.tolist())
        floats.set("x", x)
        native.step(float(k), 1.0)
        floats.do_step(float(k), 1.0)
        np.testing.assert_array_equal(np.reshape(native.get("rows"), (12, 8)), floats.get("rows"))
        # the products of 40 terms are summed in another order by NumPy
        np.testing.assert_allclose(native.get("rest"), floats.get("rest"), rtol=1e-13)
    native.free()


class Slopes(Component):
    """Slopes of what is interpolated, as a filter that navigates by terrain needs them."""

    x = Input(2, "m", description="where")
    sample_period = Parameter("s", start=1.0, description="period")
    profile = Table(columns=(("x", "m"), ("z", "m")), rows=[[0, 1], [2, 5], [3, 4]])
    ground = Grid(
        axes=(("north", "m", [0.0, 1.0, 3.0]), ("east", "m", [0.0, 2.0])),
        surfaces=(("z", "m", [[1.0, 2.0], [4.0, 8.0], [3.0, 3.0]]),),
    )
    along = Output(2, "1", description="of the profile at x[0] x[1]")
    across = Output(2, "1", description="of the ground")
    curved = Output((2, 2), "1/m", description="of the slope of the ground")

    def height(self, x):
        return self.ground.around(north=x[0], east=x[1]).bilinear()[0]

    @every("sample_period")
    def look(self):
        self.along = jacobian(lambda x: self.profile.around(x=x[0] * x[1]).linear()[1], self.x)
        self.across = jacobian(self.height, self.x)
        self.curved = jacobian(lambda x: jacobian(self.height, x), self.x)


def test_derivatives_of_what_is_interpolated(tmp_path):
    """Slopes of a profile, and of b + c u + d v + e u v in closed form; outside, where the edge is held, they are 0."""
    (file,) = build([Slopes], tmp_path, pictures=False)
    native, floats = Slave(Unzipped(file, tmp_path / "unzipped")), Interpreter(Slopes)
    native.initialise()
    floats.setup()
    expected = {
        (0.5, 0.6): ([0.6 * 2.0, 0.5 * 2.0], [3.0 + 3.0 * 0.3, 0.5 + 1.5 * 0.5], 1.5),
        (2.0, 1.2): ([1.2 * -1.0, 2.0 * -1.0], [-0.5 - 2.0 * 0.6, 2.0 - 2.0 * 0.5], -1.0),
        (9.0, 1.0): ([0.0, 0.0], [0.0, 0.0], 0.0),
    }
    for k, (x, (along, across, twist)) in enumerate(expected.items()):
        for run in (native, floats):
            run.set("x", list(x))
        native.step(float(k), 1.0)
        floats.do_step(float(k), 1.0)
        for name, wanted in (("along", along), ("across", across), ("curved", [0.0, twist, twist, 0.0])):
            np.testing.assert_allclose(native.get(name), wanted, rtol=0, atol=1e-14)
            np.testing.assert_array_equal(native.get(name), np.ravel(floats.get(name)))
    native.free()


def test_row_and_next_row_by_time_are_one_search():
    class Timed(Component):
        """Timed."""

        sample_period = Parameter("s", start=1.0, description="period")
        table = Table(columns=(("time", "s"), ("x", "m")), rows=[[0, 1], [2, 5]])
        x = Output("m", description="x")
        same = Output("m", description="x")

        @every("sample_period")
        def look(self):
            row, after = self.table.row, self.table.next_row
            self.x = row[1] + (self.time - row[0]) / (after[0] - row[0]) * (after[1] - row[1])
            self.same = self.table.around(time=self.time).linear()[1]

    assert generate(lower(Timed), "guid").count("table_rows(") == 1
    run = Interpreter(Timed)
    run.setup()
    run.do_step(0.0, 1.0)
    assert run.get("x") == run.get("same") == 3.0


def test_a_requirement_may_look_up_what_parameters_say(tmp_path):
    class Bounded(Component):
        """Bounded."""

        height = Parameter("m", start=5.0, description="height")
        sample_period = Parameter("s", start=1.0, description="period")
        limits = Table(columns=(("height", "m"), ("speed", "m/s")), rows=[[0, 10], [10, 20]])
        speed = Parameter("m/s", start=12.0, description="speed")
        x = Output("m", description="x")

        @require("speed {speed} is above its limit at {height} m")
        def slow(self):
            return self.speed <= self.limits.around(height=self.height).linear()[1]

        @every("sample_period")
        def step(self):
            self.x = self.height

    (file,) = build([Bounded], tmp_path, pictures=False)
    fmu = Unzipped(file, tmp_path / "unzipped")
    for speed, good in ((14.9, True), (15.1, False)):
        native, floats = Slave(fmu), Interpreter(Bounded)
        floats.set("speed", speed)
        assert (native.initialise(speed=speed) == OK) == good
        if good:
            floats.setup()
        else:
            assert native.said == "speed 15.1 is above its limit at 5 m"
            with pytest.raises(NavfmuError, match=r"speed 15.1 is above its limit at 5 m"):
                floats.setup()
        native.free()


def looking(look):
    class Wrong(Component):
        """Wrong."""

        x = Input("m", description="x")
        sample_period = Parameter("s", start=1.0, description="period")
        profile = Table(columns=(("distance", "m"), ("height", "m")), rows=[[0, 1], [2, 5]])
        both = Table(columns=(("distance", "m"), ("height", "m")), rows=[[0, 1], [2, 5]], key=("distance", "height"))
        ground = Grid(
            axes=(("north", "m", [0, 1]), ("east", "m", [0, 1])), surfaces=(("height", "m", [[0, 1], [2, 3]]),)
        )
        y = Output("m", description="y")

        @every("sample_period")
        def step(self):
            self.y = look(self)

    return Wrong


MISTAKES = {
    "by time": (lambda s: s.profile.row[1], "Table 'profile' is searched by 'distance', not by 'time'"),
    "by a misspelt column": (
        lambda s: s.profile.around(distanse=s.x).row[1],
        "Table 'profile' is searched by 'distance', not by 'distanse'; did you mean 'distance'?",
    ),
    "by a column that is no key": (
        lambda s: s.profile.around(height=s.x).row[1],
        "Table 'profile' is searched by 'distance', not by 'height'",
    ),
    "by nothing": (lambda s: s.profile.around().row[1], "is searched by 'distance', not by nothing"),
    "by two at a time": (
        lambda s: s.both.around(distance=s.x, height=s.x).row[1],
        "Table 'both' is searched by 'distance' or 'height', not by 'distance' and 'height'",
    ),
    "by one axis": (
        lambda s: s.ground.around(north=s.x).bilinear()[0],
        "Grid 'ground' is searched by 'north' and 'east', not by 'north'",
    ),
    "by a position": (
        lambda s: s.profile.around(s.x).row[1],
        "Table 'profile' is searched by name, around(distance=...)",
    ),
    "by a position in one of two columns": (
        lambda s: s.both.around(s.x).row[1],
        "Table 'both' is searched by name, around(distance=...) or around(height=...)",
    ),
    "by a position on two axes": (
        lambda s: s.ground.around(s.x, s.x).bilinear()[0],
        "Grid 'ground' is searched by name, around(north=..., east=...)",
    ),
}


@pytest.mark.parametrize("mistake", MISTAKES)
def test_a_wrong_search_is_told_with_file_line_and_the_keys(mistake):
    look, sentence = MISTAKES[mistake]
    with pytest.raises(NavfmuError) as caught:
        lower(looking(look))
    assert sentence in str(caught.value)
    assert f"{__file__}, line {look.__code__.co_firstlineno}" in str(caught.value)
    run = Interpreter(looking(look))
    run.setup()
    with pytest.raises(NavfmuError) as caught:
        run.do_step(0.0, 1.0)
    assert sentence in str(caught.value)


def test_a_table_cannot_be_assigned():
    def assign(self):
        self.ground = 3.0

    with pytest.raises(NavfmuError, match="grid 'ground' cannot be assigned"):
        lower(looking(assign))
