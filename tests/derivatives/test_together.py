"""Derivatives together with what else a component may use: terrain, tables, loops, functions that are called."""

import numpy as np
import pytest

from navfmu.derivatives import jacobian, value_and_jacobian
from navfmu.export import Component, Grid, Input, Output, Parameter, Table, every
from navfmu.repetition import repeat
from tests.models.native import Native, interpret

from .differences import extrapolated

NORTH, EAST = np.linspace(0.0, 400.0, 9), np.linspace(-200.0, 200.0, 6)
HEIGHT = 100.0 + 20.0 * np.sin(NORTH / 90.0)[:, None] * np.cos(EAST / 70.0) + 0.1 * NORTH[:, None]
DENSITY = np.column_stack([np.linspace(0.0, 5000.0, 6), 1.225 * np.exp(-np.linspace(0.0, 5000.0, 6) / 8000.0)])


def bilinear(x):
    """Height of the terrain at north, east, written anew; to be differentiated within a cell."""
    i, j = np.searchsorted(NORTH, x[0]) - 1, np.searchsorted(EAST, x[1]) - 1
    u = (x[0] - NORTH[i]) / (NORTH[i + 1] - NORTH[i])
    v = (x[1] - EAST[j]) / (EAST[j + 1] - EAST[j])
    corners = HEIGHT[i : i + 2, j : j + 2]
    return np.array([1.0 - u, u]) @ corners @ np.array([1.0 - v, v])


def cube_root(x, a):
    """A step of Newton's method."""
    value, slope = value_and_jacobian(lambda x: x**3 - a, x)
    return x - value / slope


class Together(Component):
    """Slopes of terrain and of a table, and of loops whose count is a parameter."""

    pace = Parameter("s", start=0.1, description="period")
    steps = Parameter("1", kind="integer", start=5, min=0, max=20, description="steps of iterations")
    place = Input(2, "m", start=[170.0, 30.0], description="north, east")
    height = Input("m", start=2300.0, description="height in the air")

    terrain = Grid(axes=(("north", "m", NORTH), ("east", "m", EAST)), surfaces=(("height", "m", HEIGHT),))
    air = Table(columns=(("height", "m"), ("density", "kg/m3")), rows=DENSITY, key="height")

    clearance = Output("m", description="height above terrain")
    by_place = Output(2, "1", description="its derivatives")
    by_height = Output("kg/m4", description="change of density with height")
    root = Output("1", description="cube root by Newton's method, whose derivative is not written")
    turned = Output(2, "1", description="a point after some turns")
    by_start = Output((2, 2), "1", description="its derivatives by where it began")

    @every("pace")
    def look(self):
        def above(x):
            return self.height - self.terrain.around(north=x[0], east=x[1]).bilinear()[0]

        self.clearance, self.by_place = value_and_jacobian(above, self.place)
        self.by_height = jacobian(lambda h: self.air.around(height=h).linear()[1], self.height)
        self.root = repeat(lambda x: cube_root(x, self.height), 10.0, self.steps + 10, 30)

        def turns(x):
            return repeat(lambda x: x + 0.1 * np.array([-x[1], np.sin(x[0])]), x, self.steps, 20)

        self.turned, self.by_start = value_and_jacobian(turns, self.place / 100.0)


@pytest.fixture(scope="module")
def native(tmp_path_factory):
    return Native(Together, tmp_path_factory.mktemp("together"))


PLACES = [(170.0, 30.0), (30.0, -170.0), (399.0, 199.0), (60.0, 10.0)]
NAMES = ("clearance", "by_place", "by_height", "root", "turned", "by_start")


@pytest.mark.parametrize("place", PLACES)
@pytest.mark.parametrize("steps", [0, 5, 20])
def test_derivatives_of_searches_and_loops(place, steps, native):
    """The cell that is found is a constant, where the point is in it is not; a loop has as many factors as steps."""
    one = interpret(Together, place=place, steps=steps)
    one.do_step(0.0, 0.1)
    found = {name: np.array(one.get(name)) for name in NAMES}
    x = np.array(place)
    truth, bound = extrapolated(bilinear, x)
    assert np.isclose(found["clearance"], 2300.0 - bilinear(x), rtol=1e-14)
    assert np.all(np.abs(found["by_place"] + truth) <= bound)
    rows = DENSITY[[2, 3]]
    np.testing.assert_allclose(found["by_height"], np.diff(rows[:, 1])[0] / np.diff(rows[:, 0])[0], rtol=1e-13)
    np.testing.assert_allclose(found["root"], 2300.0 ** (1.0 / 3.0), rtol=1e-14)

    def turns(x):
        for _ in range(steps):
            x = x + 0.1 * np.array([-x[1], np.sin(x[0])])
        return x

    np.testing.assert_array_equal(found["turned"], turns(x / 100.0))
    truth, bound = extrapolated(turns, x / 100.0)
    assert np.all(np.abs(found["by_start"] - truth) <= bound)
    recorded = native.run(0.1, 0.1, NAMES, {"steps": steps, "place": place})
    for name in NAMES:
        np.testing.assert_allclose(recorded[name][-1].ravel(), found[name].ravel(), rtol=1e-14, atol=1e-15)


def test_beyond_the_terrain_its_edge_goes_on_level():
    one = interpret(Together, place=(500.0, 70.0))
    one.do_step(0.0, 0.1)
    assert one.get("by_place")[0] == 0.0 and one.get("by_place")[1] != 0.0
