"""Small components that the exporter's tests share."""

from enum import IntEnum

import numpy as np

from navfmu.export import Bundle, Component, Grid, Input, Output, Parameter, State, Table, every, on_new, require, start
from navfmu.repetition import repeat


class Sensor(Component):
    """Noisy sensor.

    Its reading is s = u + b + w, with a random bias b.
    """

    u = Input(2, "m", description="true value")
    broken = Input(kind="boolean", fault=True, description="no readings while true")
    sigma = Parameter("m", start=0.1, min=0, max=10, description="1-sigma of bias and noise")
    gain = Parameter("1", start=1.0, min=0.5, tunable=True, description="scale factor")
    sample_period = Parameter("s", start=0.1, min=1e-3, description="sampling period")
    bias = State(2, "m", description="bias")
    reading = Bundle(s=Output(2, "m", description="measured value"), description="measurement")

    @start
    def turn_on(self, noise):
        self.bias = self.sigma * noise(2)

    @every("sample_period")
    def sample(self, noise):
        s = self.gain * self.u + self.bias + self.sigma * noise(2)
        self.reading.publish(s=s, when=~self.broken)

    @require("sigma {sigma} m must be below a tenth of gain {gain}")
    def precise(self):
        return self.sigma <= 0.1 * self.gain


class Listener(Component):
    """Counts and holds what a bundle brings."""

    tick = "sample_period"
    reading = Bundle(s=Input(2, "m", description="measured value"))
    sample_period = Parameter("s", start=0.1, min=1e-3, description="sampling period")
    held = Output(2, "m", description="last value")
    seen_at = Output("s", description="time of the last update")
    updates = Output(kind="integer", description="number of updates")

    @on_new("reading")
    def update(self):
        self.held = np.where(self.reading.valid, self.reading.s, self.held)
        self.seen_at = self.time
        self.updates = self.updates + 1


class Source(Component):
    """Ramp from a table: a source whose output is known at t = 0."""

    offset = Parameter("m", start=0.5, description="added to the table")
    sample_period = Parameter("s", start=0.05, min=1e-3, description="sampling period")
    track = Table(columns=(("time", "s"), ("x", "m")), rows=[[0.0, 0.0], [1.0, 2.0], [3.0, 0.0]])
    x = Output("m", description="position")

    @start
    def begin(self):
        self.x = self.track.row[1] + self.offset

    @every("sample_period")
    def move(self):
        row, following = self.track.row, self.track.next_row
        part = np.clip((self.time - row[0]) / (following[0] - row[0]), 0.0, 1.0)
        self.x = row[1] + part * (following[1] - row[1]) + self.offset


class Rows(Component):
    """The rows that a table gives a task, as they are."""

    sample_period = Parameter("s", start=0.5, min=1e-3, description="sampling period")
    track = Table(columns=(("time", "s"), ("x", "m")), rows=[[0.0, 1.0], [1.0, 2.0], [2.5, 4.0], [3.0, 8.0]])
    row = Output(2, "1", description="row at or before the time of the task")
    next_row = Output(2, "1", description="the row that follows")

    @start
    def begin(self):
        self.row, self.next_row = self.track.row, self.track.next_row

    @every("sample_period")
    def look(self):
        self.row, self.next_row = self.track.row, self.track.next_row


class Searcher(Component):
    """What is found in tables and grids around values that tasks calculate, in loops, and by a parameter."""

    x = Input(3, "m", description="where to look")
    y = Input("m", description="where to look on the second axis")
    scale = Parameter("1", start=2.0, tunable=True, description="of what is looked for")
    mark = Parameter("m", start=1.5, description="where to look once and for all")
    sample_period = Parameter("s", start=0.5, min=1e-3, description="sampling period")
    profile = Table(
        columns=(("index", "1"), ("x", "m"), ("angle", "rad"), ("z", "m")),
        rows=[[0, -4, 9, 1], [1, 0, 3, 2], [2, 1, 4, 4], [3, 1.5, 1, 8], [4, 9, 5, 7]],
        key=("x", "index"),
    )
    ground = Grid(
        axes=(("north", "m", [-1.0, 0.0, 2.0, 2.5]), ("east", "m", [-4.0, 0.0, 3.0])),
        surfaces=(
            ("height", "m", [[1, 2, 0], [4, 8, 1], [6, 3, 5], [7, 0, 2]]),
            ("slope", "1", [[0.5, 1, 2], [3, 0.25, 4], [1, 1, 3], [0, 2, 5]]),
        ),
    )
    rows = Output((3, 8), "1", description="both rows around each x")
    between = Output((3, 4), "1", description="the row in between")
    by_index = Output("m", description="z by another column")
    many = Output(3, "m", description="z at scale x")
    corners = Output(8, "1", description="corners around (x[0], y)")
    ends = Output(4, "m", description="ends of that cell")
    surface = Output(2, "1", description="both surfaces there")
    along = Output(3, "m", description="height along x")
    fixed = Output(2, "m", description="z and height at the mark")

    @start
    def begin(self):
        self.by_index = self.profile.around(index=2.0).row[3]

    @every("sample_period")
    def look(self):
        found = [self.profile.around(x=self.x[i]) for i in range(3)]
        self.rows = np.array([np.concatenate([here.row, here.next_row]) for here in found])
        self.between = np.array([here.linear() for here in found])
        self.by_index = self.profile.around(index=self.x[0] - self.x[1]).linear()[3]
        self.many = self.profile.around(x=self.scale * self.x).linear()[:, 3]
        here = self.ground.around(north=self.x[0], east=self.y)
        self.corners, self.ends = here.corners.ravel(), np.concatenate(here.ends)
        self.surface = here.bilinear()
        self.along = self.ground.around(east=self.y, north=self.x).bilinear()[:, 0]
        self.fixed = np.array(
            [self.profile.around(x=self.mark).linear()[3], self.ground.around(north=self.mark, east=0.5).bilinear()[0]]
        )


class Planned(Component):
    """A table and a grid whose files are named by strings, and a table that is its own."""

    plan_file = Parameter(kind="string", longest=300, description="file of the plan")
    field_file = Parameter(kind="string", longest=300, description="file of the field")
    most = Parameter("m", start=1e3, description="highest altitude of the plan at the start")
    sample_period = Parameter("s", start=0.5, min=1e-3, description="sampling period")
    plan = Table(columns=(("time", "s"), ("x", "m")), rows=[[0.0, 1.0], [4.0, 9.0]], file="plan_file")
    field = Grid(
        axes=(("x", "m", [0.0, 9.0]), ("y", "m", [0.0, 1.0])),
        surfaces=(("z", "m", [[0.0, 1.0], [9.0, 10.0]]),),
        file="field_file",
    )
    own = Table(columns=(("time", "s"), ("x", "m")), rows=[[0.0, 7.0], [4.0, 7.0]])
    x = Output("m", description="plan")
    z = Output("m", description="field at the plan")
    first = Output("m", description="first row of the plan, found by a constant")

    @require("the plan begins above {most}")
    def low(self):
        return self.plan.around(time=0.0).row[1] <= self.most

    def find(self):
        self.x = self.plan.around(time=self.time).linear()[1]
        (self.z,) = self.field.around(x=self.x, y=0.5).bilinear()
        self.first = self.plan.around(time=-1.0).row[1] + self.own.row[1] - 7.0

    @start
    def begin(self):
        self.find()

    @every("sample_period")
    def fly(self):
        self.find()


class Terrain(Component):
    """A grid alone."""

    place = Input(2, "m", description="place")
    sample_period = Parameter("s", start=0.5, min=1e-3, description="sampling period")
    ground = Grid(
        axes=(("north", "m", [0.0, 1.0, 5.0]), ("east", "m", [0.0, 2.0])),
        surfaces=(("height", "m", [[1.0, 2.0], [3.0, 4.0], [5.0, 6.0]]), ("slope", "1", np.ones((3, 2)))),
    )
    height = Output("m", description="height")

    @every("sample_period")
    def look(self):
        self.height = self.ground.around(north=self.place[0], east=self.place[1]).bilinear()[0]


class TwoRates(Component):
    """Two clocks, with tasks that see each other's results in the order of their declaration."""

    u = Input("m", description="input")
    fast = Parameter("s", start=0.1, min=0.01, description="fast period")
    slow = Parameter("s", start=0.3, min=0.01, description="slow period")
    count = Output(2, "1", description="runs of the fast and the slow task")
    slow_sees = Output("1", description="fast runs that the slow task saw")
    sampled = Output("m", description="input at the last fast tick")
    times = Output(2, "s", description="time of the last fast and slow tick")
    periods = State(2, "s", description="periods as the tasks see them")

    @every("fast")
    def quick(self):
        self.count = self.count + np.array([1.0, 0.0])
        self.sampled = self.u
        self.times = np.array([self.time, self.times[1]])
        self.periods = np.array([self.period, self.periods[1]])

    @every("slow")
    def calm(self):
        self.count = self.count + np.array([0.0, 1.0])
        self.slow_sees = self.count[0]
        self.times = np.array([self.times[0], self.time])
        self.periods = np.array([self.periods[0], self.period])


class Lag(Component):
    """First-order lag whose factor follows from parameters, of which one can be tuned, and from the start task."""

    u = Input("m", description="input")
    time_constant = Parameter("s", start=1.0, min=0.01, description="time constant")
    gain = Parameter("1", start=1.0, tunable=True, description="gain")
    sample_period = Parameter("s", start=0.1, min=0.01, description="sampling period")
    offset = State("m", description="made at the start")
    y = Output("m", description="output")

    @start
    def begin(self):
        self.offset = 2.0 * self.time_constant

    @every("sample_period")
    def lag(self):
        factor = np.exp(-self.period / self.time_constant)
        self.y = factor * self.y + (1.0 - factor) * self.gain * self.u + np.sqrt(1.0 + self.offset) * np.sqrt(self.gain)


class Mixed(Component):
    """Variables of every kind, and tasks that fail when an Integer would get a fraction."""

    u = Input("m", description="continuous input")
    level = Input(kind="integer", min=0, max=10, description="Integer input")
    on = Input(kind="boolean", start=True, description="Boolean input")
    offset = Parameter("m", start=1.0, min=-5.0, description="fixed parameter; the start task takes it for whole")
    stride = Parameter("1", start=1.0, max=4.0, tunable=True, description="what the count goes up by")
    number = Parameter(kind="integer", start=3, min=0, max=9, tunable=True, description="tunable Integer")
    sample_period = Parameter("s", start=0.1, description="sampling period")
    covariance = State(2, "m2", start=(1.0, 2.0), description="a state that can be set before initialisation")
    begun = State(kind="integer", description="a state that the start task calculates")
    first = Output("m", description="an output that the start task calculates")
    y = Output("m", start=4.0, description="an output with a start value")
    count = Output(kind="integer", description="goes up by the stride")
    seen = Output(kind="boolean", description="whether it was on")

    @start
    def begin(self):
        self.begun = self.offset
        self.first = self.offset + self.covariance[0]

    @every("sample_period")
    def step(self):
        self.y = np.where(self.on, self.y + self.u * self.level, self.y)
        self.count = self.count + self.stride
        self.seen = self.on


MOST = 40  # ticks that the next component can tell of


class Ticking(Component):
    """Tells when it was run: the times of its ticks, the periods that it was told and what noise it got."""

    period_ = Parameter("s", start=0.25, max=100, tunable=True, description="period")
    phase = Parameter("s", start=0.0, max=50, description="time of the first tick")
    steady = Parameter("s", start=0.5, min=1e-3, description="period of the other clock")
    ticks = Output(kind="integer", description="number of ticks")
    times = Output(MOST, "s", start=-1.0, description="times of the ticks")
    periods = Output(MOST, "s", start=-1.0, description="periods that they were told")
    noises = Output(MOST, "1", start=-1.0, description="noise that they got")
    others = Output("s", start=-1.0, description="time of the last tick of the other clock")

    @every("period_", offset="phase")
    def tell(self, noise):
        here = np.arange(MOST) == self.ticks
        self.times = np.where(here, self.time, self.times)
        self.periods = np.where(here, self.period, self.periods)
        self.noises = np.where(here, noise(1)[0], self.noises)
        self.ticks = self.ticks + 1

    @every("steady", offset="phase")
    def other(self):
        self.others = self.time


class Lock(IntEnum):
    """What a receiver does."""

    SEARCH = 1
    TRACK = 2
    MEMORY = 3


class Modes(Component):
    """A receiver that goes from one mode to another, as it is commanded."""

    command = Input(kind="enumeration", items=("off", "hold", "go on"), start="hold", description="what to do")
    stride = Parameter(kind="integer", start=1, min=-9, max=9, tunable=True, description="how far the mode goes")
    first = Parameter(kind="enumeration", items=Lock, start=Lock.TRACK, description="mode at the start")
    sample_period = Parameter("s", start=0.1, min=1e-3, description="sampling period")
    mode = Output(kind="enumeration", items=Lock, description="mode")
    history = Output(2, kind="enumeration", items=Lock, start=("MEMORY", 1), description="modes before it")
    seen = Output("1", start=-1.0, description="0 in search, 1 in track, 0.5 in memory")

    @start
    def begin(self):
        self.mode = self.first

    @every("sample_period")
    def step(self):
        self.history = np.array([self.mode, self.history[0]])
        held = np.where(self.command == 1, Lock.SEARCH, self.mode)
        self.mode = np.where(self.command == 3, self.mode + self.stride, held)
        self.seen = np.where(self.mode == Lock.TRACK, 1.0, np.where(self.mode == Lock.MEMORY, 0.5, 0.0))


class Named(Component):
    """A station that has a name."""

    u = Input("m", description="input")
    station = Parameter(kind="string", start="TUL", longest=8, description="name of the station")
    others = Parameter(3, kind="string", start=("", "a b", "Zürich"), description="names of others")
    gain = Parameter("1", start=1.0, min=0.0, max=2.0, description="gain")
    sample_period = Parameter("s", start=0.1, min=1e-3, description="sampling period")
    begun = Output("1", description="an output that the start task calculates")
    y = Output("m", description="output")

    @start
    def begin(self):
        self.begun = 2.0 * self.gain

    @every("sample_period")
    def step(self):
        self.y = self.gain * self.u


def nearer(root, square):
    """Return a better square root, sqrt(m2), by Newton's method."""
    return 0.5 * (root + square / root)


class Iterating(Component):
    """Square roots by as many steps of Newton's method as a parameter says, none to eight."""

    u = Input(3, "m2", start=(1.0, 4.0, 9.0), description="squares")
    iterations = Parameter(kind="integer", start=4, min=0, max=8, tunable=True, description="steps of the method")
    sample_period = Parameter("s", start=0.1, min=1e-3, description="sampling period")
    root = Output(3, "m", description="roots")
    steps = Output(kind="integer", description="steps that were made")

    @every("sample_period")
    def solve(self):
        begin = np.maximum(self.u, 1.0), 0
        self.root, self.steps = repeat(lambda s: (nearer(s[0], self.u), s[1] + 1), begin, self.iterations, 8)


def updated(state, covariance, row, variance, residual):
    """A Kalman filter's update by one measurement."""
    cross = covariance @ row
    gain = cross / (row @ cross + variance)
    return state + gain * residual, covariance - np.outer(gain, cross)


class Wide(Component):
    """A filter of 24 states whose arrays are kept whole, and whose update is a function that is called."""

    SIZE, ROWS = 24, 6

    measured = Input(ROWS, "m", description="measurements")
    noise_variance = Parameter(ROWS, "m2", start=4.0, min=1e-6, description="variances of the measurements")
    coupling = Parameter("1", start=0.1, min=0.0, max=0.5, description="how much each state is driven by the next one")
    sample_period = Parameter("s", start=0.1, min=1e-3, description="sampling period")
    state = Output(SIZE, "m", description="estimated states")
    covariance = State(
        (SIZE, SIZE), "m2", start=np.diag(25.0 + np.arange(SIZE)), description="covariance of their error"
    )
    sigmas = Output(SIZE, "m", description="standard deviations, in order")
    worst = Output(kind="integer", description="the state that is known worst")
    weights = Output(ROWS, "1", description="of the measurements in a fit of one number to them")

    @every("sample_period")
    def estimate(self):
        transition = 0.9 * np.eye(self.SIZE)
        for i in range(self.SIZE - 1):
            transition[i, i + 1] = self.coupling
        state, covariance = transition @ self.state, transition @ self.covariance @ transition.T
        covariance = covariance + 0.01 * np.eye(self.SIZE)
        for i in range(self.ROWS):
            row = np.zeros(self.SIZE)
            row[4 * i] = 1.0
            row[4 * i + 3] = -self.coupling
            residual = self.measured[i] - row @ state
            state, covariance = updated(state, covariance, row, self.noise_variance[i], residual)
        self.state, self.covariance = state, covariance
        variances = np.diagonal(covariance)
        self.sigmas = np.sqrt(np.sort(variances))
        self.worst = np.argmax(variances)
        block = covariance[:: 24 // self.ROWS, :: 24 // self.ROWS] + np.diag(self.noise_variance)
        shares = np.linalg.solve(block, np.ones(self.ROWS))
        self.weights = shares / np.cumsum(shares)[-1]
