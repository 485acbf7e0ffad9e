"""Arrays of any number of dimensions, arrays of bundles, and banks of filters: native, interpreted and by hand."""

import re

import fmpy
import numpy as np
import pytest
from fmpy.validation import validate_fmu

from navfmu.errors import NavfmuError
from navfmu.export import Bundle, Component, Input, Output, Parameter, State, every, on_new, start
from navfmu.export.build import build
from navfmu.export.interpreter import Interpreter
from navfmu.export.page.documentation import page
from navfmu.export.page.picture import panels
from navfmu.export.page.response import step_response
from navfmu.export.printing.codegen import generate
from navfmu.export.tracing.lower import lower
from navfmu.export.twin import build_twin

from .arrays import Beacons, BeaconsAtOnce, Cube, Grid, Receiver, bank, listener
from .slave import OK, Slave, Unzipped

COMPONENTS = {c.layout.name: c for c in (Cube, Beacons, BeaconsAtOnce, Receiver, Grid)}


@pytest.fixture(scope="module")
def fmus(tmp_path_factory):
    """Name -> path of the native FMU."""
    return {path.stem: path for path in build(COMPONENTS.values(), tmp_path_factory.mktemp("arrays"))}


class Both:
    """An FMU and the interpreter, to which the same is done; everything in both is equal to the last bit."""

    def __init__(self, path, folder, component):
        self.native, self.interpreted = Slave(Unzipped(path, folder)), Interpreter(component)
        assert self.native.initialise() == OK, self.native.said
        self.interpreted.setup()

    def set(self, name, value):
        assert self.native.set(name, value) == OK, self.native.said
        self.interpreted.set(name, value)

    def step(self, time, h):
        assert self.native.step(time, h) == OK, self.native.said
        self.interpreted.do_step(time, h)
        everything = [self.interpreted.get(name) for name in self.native.fmu.variables]
        assert self.native.everything() == everything

    def get(self, name):
        return self.interpreted.get(name)


@pytest.fixture
def both(fmus, tmp_path):
    return lambda component: Both(fmus[component.layout.name], tmp_path, component)


# ---- arrays ----------------------------------------------------------------------------------------------------------


def test_three_and_four_dimensions(both):
    """Numbers that differ in each element, and axes of different lengths: an order other than C's would show."""
    run, random = both(Cube), np.random.default_rng(6)
    total, scale = np.zeros((2, 3)), np.array([1.0, 2.0, 3.0, 4.0])
    for k in range(3):
        u, off = random.normal(size=(2, 3, 4)), random.random((2, 3, 4)) < 0.3
        for i, j, n in np.ndindex(u.shape):
            run.set(f"u[{i + 1},{j + 1},{n + 1}]", u[i, j, n])
            run.set(f"off[{i + 1},{j + 1},{n + 1}]", bool(off[i, j, n]))
        run.step(0.1 * k, 0.1)
        scaled = np.where(off, 0.0, u) * scale
        total += scaled.sum(-1)
        for i, j, n in np.ndindex(u.shape):
            assert run.get(f"turned[{n + 1},{i + 1},{j + 1}]") == scaled[i, j, n]
        np.testing.assert_allclose(run.get("total"), total[None, :, :, None], rtol=1e-14)
        assert run.get("count").tolist() == ((k + 2) * np.arange(8).reshape(2, 2, 2)).tolist()
        assert [run.get(f"layers.half[{i},1,{j}]") for i in (1, 2, 3) for j in (1, 2)] == (
            0.5 * scaled[0, :, :2]
        ).ravel().tolist()


def test_a_variable_is_one_record_with_a_first_reference():
    model = lower(Cube)
    assert [(v.name, v.shape) for v in model.variables][4:8] == [
        ("turned", (4, 2, 3)), ("total", (1, 2, 3, 1)), ("count", (2, 2, 2)), ("layers.half", (3, 1, 2)),
    ]  # fmt: skip
    for variable in model.variables:
        assert [e.index for e in variable.elements()] == list(variable.indices)
        assert [e.place for e in variable.elements()] == list(np.ndindex(variable.shape))
        assert [model.elements[i] for i in variable.indices] == list(variable.elements())
    count = next(v for v in model.variables if v.name == "count")
    assert count.start == tuple(range(8)) and count.elements()[5].name == "count[2,1,2]"


def test_hosts_see_structured_names(fmus):
    for path in fmus.values():
        assert validate_fmu(str(path)) == []
        assert fmpy.read_model_description(str(path)).variableNamingConvention == "structured"
    names = {v.name for v in fmpy.read_model_description(str(fmus["beacons"])).modelVariables}
    assert {"beacon[1].range", "beacon[3].parts[2]", "beacon[2].valid", "beacon[3].sequence"} <= names


def test_the_twin_has_the_same_variables_and_values(fmus, tmp_path):
    for component in (Cube, Beacons, Receiver):
        twin = build_twin(component, tmp_path, pictures=False)
        results = [fmpy.simulate_fmu(str(path), stop_time=0.5, step_size=0.1, output_interval=0.1)
                   for path in (fmus[component.layout.name], twin)]  # fmt: skip
        assert results[0].dtype.names == results[1].dtype.names
        assert results[0].tolist() == results[1].tolist()


@pytest.mark.parametrize(
    ("make", "told"),
    [
        (lambda: Input(0, "m"), "shape 0 is none; expected a whole number from 1 on"),
        (lambda: Input((2, -1), "m"), r"shape \(2, -1\) is none"),
        (lambda: Input(2.5, "m"), "shape 2.5 is none"),
        (lambda: Input(True, "m"), "shape True is none"),
        (lambda: Input(3, "m", "s"), "two units are given, 'm' and 's'"),
        (lambda: Input(2, 3, "m", start=np.zeros((3, 2))), r"start has shape \(3, 2\), expected a number or \(2, 3\)"),
        (lambda: Bundle("m", x=Input("m")), "shape 'm' is none"),
        (lambda: Bundle(3, x=Input("m"), y=Output("m")), "all Input or all Output"),
    ],
)
def test_what_is_no_shape_is_refused(make, told):
    with pytest.raises(NavfmuError, match=rf"test_declared_arrays\.py, line \d+: .*{told}"):
        make()


def test_shapes_may_be_given_number_by_number():
    """The last number alone would make a bank of 4 x 15 states one of 15."""
    assert State(4, 15, "m").shape == State((4, 15), "m").shape == State((4,), 15, "m").shape == (4, 15)


# ---- arrays of bundles -----------------------------------------------------------------------------------------------


@pytest.mark.parametrize("component", [Beacons, BeaconsAtOnce])
def test_bundles_of_an_array_are_announced_one_by_one(both, component):
    """One that is not published keeps its number, its time and its values, whatever its neighbours do."""
    run = both(component)
    number, at, shown = [0, 0, 0], [0.0] * 3, [0.0] * 3
    for k, on in enumerate([(1, 1, 1), (1, 0, 1), (0, 0, 0), (0, 1, 0)], start=1):
        u = [10.0 * k, 20.0 * k, 30.0 * k]
        run.set("u", u)
        run.set("on", on)
        run.step(0.1 * (k - 1), 0.1)
        for i in range(3):
            if on[i]:
                number[i], at[i], shown[i] = number[i] + 1, 0.1 * k, u[i]
            assert run.get(f"beacon[{i + 1}].range") == shown[i]
            assert run.get(f"beacon[{i + 1}].parts").tolist() == [0.5 * shown[i], -0.5 * shown[i]]
            assert run.get(f"beacon[{i + 1}].valid") == (0 < shown[i] < 40.0)
            assert run.get(f"beacon[{i + 1}].time_of_validity") == pytest.approx(at[i], abs=1e-12)
        assert run.get("beacon.sequence").tolist() == number


def test_a_task_runs_for_each_bundle_that_has_new_data(both):
    """One counter and one number for all would take the second beacon's jump for the first one's loss."""
    run = both(Receiver)
    for i in range(3):
        run.set(f"beacon[{i + 1}].range", 1.0 + i)
        run.set(f"beacon[{i + 1}].valid", i < 2)
    run.set("beacon[2].parts", [5.0, -6.0])
    run.set("beacon[2].sequence", 3)
    run.set("beacon[3].sequence", 1)
    run.step(0.0, 0.1)
    assert run.get("updates").tolist() == [0, 1, 1]
    assert run.get("beacon.lost").tolist() == [0, 2, 0]
    assert run.get("held").tolist() == [0.0, 11.0, 0.0]  # the third is not valid
    assert run.get("seen_at").tolist() == [0.0, 0.1, 0.1]
    assert run.get("farthest") == 3.0
    run.set("beacon[1].sequence", 1)
    run.step(0.1, 0.1)
    run.set("beacon[2].sequence", 5)
    run.step(0.2, 0.1)
    assert run.get("updates").tolist() == [1, 2, 1]
    assert run.get("beacon.lost").tolist() == [0, 3, 0]
    drawn = run.get("drawn")
    assert len(set(drawn.tolist())) == 3 and np.all(drawn != 0.0)  # each has a stream of its own


def test_bundles_in_rows_and_columns(both):
    run = both(Grid)
    for row, column in ((1, 2), (2, 3)):
        run.set(f"cell[{row},{column}].value", 100.0)
        run.set(f"cell[{row},{column}].sequence", 1)
    run.step(0.0, 0.1)
    assert run.get("back.value").tolist() == [[0.0, 110.0, 0.0], [0.0, 0.0, 121.0]]
    assert run.get("back.sequence").tolist() == [[0, 1, 0], [0, 0, 1]]


def test_members_of_arrays_of_bundles_are_one_record_each():
    model = lower(Beacons)
    parts = next(v for v in model.variables if v.name == "beacon.parts")
    assert (parts.shape, parts.bundles, parts.bundle) == ((3, 2), (3,), "beacon")
    assert [e.name for e in parts.elements()] == [f"beacon[{i}].parts[{j}]" for i in (1, 2, 3) for j in (1, 2)]
    assert [e.bundle for e in parts.elements()] == ["beacon[1]"] * 2 + ["beacon[2]"] * 2 + ["beacon[3]"] * 2


def test_the_page_has_a_row_for_each_and_not_for_each_bundle():
    html = re.sub(r"<[^>]+>", " ", page(lower(Receiver), None, [Receiver]))
    assert "beacon[1]…[3].range" in html and "beacon[1]…[3].parts[1]…[2]" in html and "held[1]…[3]" in html
    assert html.count("take[1]…take[3]") == 1
    assert re.search(r"new data in its own of\s+beacon\[1\]\s+to\s+beacon\[3\]", html)
    assert "turned[1,1,1]…[4,2,3]" in page(lower(Cube), None, [Cube])


def test_an_example_run_feeds_each_bundle(fmus, tmp_path):
    """Before their first data bundles show nothing; inputs of bundles are numbered, each for itself."""
    fmu = Unzipped(fmus["receiver"], tmp_path)
    library = tmp_path / "binaries" / "linux64" / "receiver.so"
    response = step_response(lower(Receiver), fmu.guid, library)
    held = [response.indices.index(fmu.reference(f"held[{i}]")) for i in (1, 2, 3)]
    assert response.fed == ["beacon"]
    assert list(panels(lower(Receiver), response)["held (m)"]) == ["[1]", "[2]", "[3]"]
    assert np.all(response.values[-1, held] == 0.0)  # both parts step alike
    seen = [response.indices.index(fmu.reference(f"seen_at[{i}]")) for i in (1, 2, 3)]
    assert np.all(response.values[-1, seen] == pytest.approx(60.0))


def test_a_receiver_must_say_that_it_is_told_which():
    with pytest.raises(NavfmuError, match=r"'take' takes self and which bundle of the array 'b', from 0, and, if it"):

        class Deaf(Component):
            """Not told."""

            T = Parameter("s", start=1.0)
            tick = "T"
            b = Bundle(2, x=Input("m"))

            @on_new("b")
            def take(self):
                pass

    with pytest.raises(NavfmuError, match=r"task 'take' takes self and, if it needs random numbers, noise"):

        class Curious(Component):
            """Asks for what there is not."""

            T = Parameter("s", start=1.0)
            tick = "T"
            b = Bundle(x=Input("m"))

            @on_new("b")
            def take(self, i):
                pass

    with pytest.raises(NavfmuError, match="two tasks wait for bundle 'b'"):

        class Twice(Component):
            """Two."""

            T = Parameter("s", start=1.0)
            tick = "T"
            b = Bundle(2, x=Input("m"))

            @on_new("b")
            def take(self, i):
                pass

            @on_new("b")
            def again(self, i):
                pass


WRONG = {
    "beyond the end": (lambda self: self.b[2], "bundles 'b' have no index 2; expected one from 0 to 1"),
    "of one bundle": (lambda self: self.b[0][0], r"'b\[1\]' is one bundle and has no length"),
    "by a value": (lambda self: self.b[self.k], "a whole number that no value changes"),
    "several": (lambda self: self.b[0:1], "a whole number that no value changes"),
    "no member": (lambda self: self.b[1].xx, r"bundle 'b\[2\]' has no member 'xx'; did you mean 'x'"),
    "assigned": (lambda self: setattr(self.b[1], "x", 1.0), r"use self\.b\[1\]\.publish\(x=\.\.\.\)"),
    "published wrong": (lambda self: self.b.publish(y=0.0), r"bundle 'b' has no member 'y'"),
    "of another shape": (lambda self: self.b[1].publish(x=self.b.x), r"'b\[2\]\.x' is assigned shape \(2,\), expected"),
    "for all": (lambda self: self.b.publish(x=0.0), r"'b\.x' is assigned shape \(\), expected \(2,\)"),
    "when": (lambda self: self.b.publish(x=self.b.x, when=np.array([True] * 3)), r"when has shape \(3,\), expected"),
}


@pytest.mark.parametrize("name", WRONG)
def test_wrong_use_is_told_in_a_sentence_wherever_it_runs(name):
    use, told = WRONG[name]

    class Wrong(Component):
        """Wrong."""

        T = Parameter("s", start=1.0)
        b = Bundle(2, x=Output("m"))
        k = State(kind="integer")

        @every("T")
        def step(self):
            self.k = self.k + 1
            use(self)

    with pytest.raises(NavfmuError, match=rf"test_declared_arrays\.py, line \d+: component Wrong: .*{told}"):
        lower(Wrong)
    if name != "by a value":  # which interpreted code knows
        run = Interpreter(Wrong)
        run.setup()
        with pytest.raises(NavfmuError, match=told):
            run.do_step(0.0, 1.0)


def test_bundles_that_a_start_task_publishes_are_calculated():
    class Known(Component):
        """Known at once; of the array one bundle only."""

        first = Bundle(2, x=Output("m"))

        @start
        def begin(self):
            self.first[1].publish(x=3.0)

    run = Interpreter(Known)
    assert {v.initial for v in run.variables} == {"calculated"}
    run.setup()
    assert (run.get("first.x").tolist(), run.get("first.sequence").tolist()) == ([0.0, 3.0], [0, 1])


def test_indices_that_there_are_not_are_told_from_where_to_where_they_go():
    run = Interpreter(Receiver)
    for name, told in (
        ("held[0]", r"indices go from 'held\[1\]' to 'held\[3\]'"),
        ("beacon[4].range", r"indices go from 'beacon\[1\]\.range' to 'beacon\[3\]\.range'"),
        ("hold[1]", r"did you mean 'held\[1\]'\?"),
        ("farthest[1]", r"did you mean 'farthest'\?"),
    ):
        with pytest.raises(NavfmuError, match=rf"There is no variable '{re.escape(name)}' in 'receiver'; {told}"):
            run.get(name)


def test_many_bundles_do_not_make_much_code(tmp_path):
    """A method is a task for each; tasks with a measure of their own each would write its function out every time."""
    few, many = (len(generate(lower(listener(count)), "x")) for count in (4, 40))
    assert many < 2 * few
    component, random = listener(40), np.random.default_rng(4)
    (path,) = build([component], tmp_path, pictures=False)
    run = Slave(Unzipped(path, tmp_path / "unzipped"))
    assert run.initialise() == OK
    rows, values = random.normal(size=(40, 8)), random.normal(size=40)
    for i in range(40):
        assert run.set_references("Real", [run.fmu.reference(f"station[{i + 1}].seen[{j + 1}]") for j in range(8)],
                                  rows[i].tolist()) == OK  # fmt: skip
        assert run.set(f"station[{i + 1}].value", values[i]) == OK
        assert run.set(f"station[{i + 1}].sequence", int(i % 2)) == OK
    assert run.step(0.0, 0.1) == OK
    sent = np.arange(40) % 2 == 1
    information = np.eye(8) + rows[sent].T @ rows[sent]
    np.testing.assert_allclose(run.get("x"), np.linalg.solve(information, rows[sent].T @ values[sent]), rtol=1e-9)


# ---- banks of filters ------------------------------------------------------------------------------------------------


def _conditioned(moved, seen, variance, measured):
    """Mean and covariance of the last state, by conditioning the Gaussian of all states on all measurements at once."""
    n, steps = len(seen), len(measured)
    variances, covariance = [], np.eye(n)
    for _ in measured:
        covariance = moved @ covariance @ moved.T + 0.01 * np.eye(n)
        variances.append(covariance)
    joint = np.zeros((steps, n, steps, n))
    for a in range(steps):
        for b in range(a, steps):
            joint[b, :, a] = np.linalg.matrix_power(moved, b - a) @ variances[a]
            joint[a, :, b] = joint[b, :, a].T
    of_measured = np.einsum("i,aibj,j->ab", seen, joint, seen) + variance * np.eye(steps)
    cross = np.einsum("iaj,j->ia", joint[-1], seen)
    gain = np.linalg.solve(of_measured, cross.T).T
    return gain @ measured, joint[-1, :, -1] - gain @ cross.T


@pytest.mark.parametrize("states", [6, 15])
def test_a_bank_of_four_filters_is_optimal_in_each(states, tmp_path):
    """Each filter has a measurement and a variance of its own; two that shared a row would not have both right."""
    component, random = bank(4, states), np.random.default_rng(9)
    run = Interpreter(component)
    run.setup()
    native = None
    if states == 6:
        (path,) = build([component], tmp_path, pictures=False)
        native = Slave(Unzipped(path, tmp_path / "unzipped"))
        assert native.initialise() == OK
    z = random.normal(size=(5, 4))
    for k in range(5):
        run.set("z", z[k])
        run.do_step(0.1 * k, 0.1)
        if native:
            assert native.set("z", z[k]) == OK and native.step(0.1 * k, 0.1) == OK
    rows, columns = np.triu_indices(states)
    for i in range(4):
        mean, covariance = _conditioned(component.moved, component.seen, 1.0 + i, z[:, i])
        np.testing.assert_allclose(run.get("x")[i], mean, rtol=1e-9, atol=1e-12)
        np.testing.assert_allclose(run.get("packed")[i], covariance[rows, columns], rtol=1e-9, atol=1e-12)
        if native:
            named = [native.get(f"x[{i + 1},{j + 1}]") for j in range(states)]
            np.testing.assert_allclose(named, mean, rtol=1e-9, atol=1e-12)
            np.testing.assert_allclose(native.get("sigma")[i], np.sqrt(covariance[0, 0]), rtol=1e-9)
    assert [(v.name, v.shape) for v in lower(component).variables][3:5] == [
        ("x", (4, states)), ("packed", (4, states * (states + 1) // 2)),
    ]  # fmt: skip
