"""Components with arrays of many dimensions, arrays of bundles and banks of filters, for the exporter's tests."""

import numpy as np

from navfmu.export import Bundle, Component, Input, Output, Parameter, State, every, on_new


class Cube(Component):
    """Arrays of three and four dimensions, of all types and causalities."""

    u = Input(2, 3, 4, "m", start=np.arange(24.0).reshape(2, 3, 4), description="input")
    off = Input((2, 3, 4), kind="boolean", fault=True, description="elements that count as 0")
    scale = Parameter(4, "1", start=[1.0, 2.0, 3.0, 4.0], min=-9.0, max=9.0, description="of the last axis")
    sample_period = Parameter("s", start=0.1, min=1e-3, description="sampling period")
    turned = Output(4, 2, 3, "m", description="scaled, last axis first")
    total = State(1, 2, 3, 1, "m", description="sum over the last axis, since the start")
    count = Output(2, 2, 2, kind="integer", start=np.arange(8).reshape(2, 2, 2), description="goes up")
    layers = Bundle(half=Output(3, 1, 2, "m", description="of the first layer"), description="layers")

    @every("sample_period")
    def turn(self):
        scaled = np.where(self.off, 0.0, self.scale * self.u)
        self.turned = np.moveaxis(scaled, -1, 0)
        self.total = self.total + np.sum(scaled, axis=-1)[None, :, :, None]
        self.count = self.count + np.arange(8).reshape(2, 2, 2)
        self.layers.publish(half=0.5 * scaled[0][:, None, :2])


class Beacons(Component):
    """Beacons that are heard one by one."""

    u = Input(3, "m", start=(10.0, 20.0, 30.0), description="true range of each")
    on = Input(3, kind="boolean", start=True, description="whether each is heard")
    sample_period = Parameter("s", start=0.1, min=1e-3, description="sampling period")
    beacon = Bundle(
        3,
        range=Output("m", description="measured range"),
        parts=Output(2, "m", description="its halves, one of them negative"),
        description="beacon",
    )

    @every("sample_period")
    def listen(self):
        for i, beacon in enumerate(self.beacon):
            half = 0.5 * self.u[i]
            beacon.publish(range=self.u[i], parts=np.stack([half, -half]), valid=half < 20.0, when=self.on[i])


class BeaconsAtOnce(Beacons):
    """The same, published as arrays."""

    @every("sample_period")
    def listen(self):
        half = 0.5 * self.u
        self.beacon.publish(range=self.u, parts=np.stack([half, -half], -1), valid=half < 20.0, when=self.on)


class Receiver(Component):
    """Counts and holds what each of three beacons brings, one task for each."""

    tick = "sample_period"
    beacon = Bundle(
        3,
        range=Input("m", description="measured range"),
        parts=Input(2, "m", description="its halves"),
        description="b",
    )
    sample_period = Parameter("s", start=0.1, min=1e-3, description="sampling period")
    held = Output(3, "m", description="last valid range of each")
    seen_at = Output(3, "s", description="when each was heard")
    updates = Output(3, kind="integer", description="how often")
    farthest = Output("m", description="largest range that was ever shown, of all")
    drawn = Output(3, "1", description="one random number for each")

    @on_new("beacon")
    def take(self, i, noise):
        """Take what one of them brings."""
        here = np.arange(3) == i
        heard = here & self.beacon[i].valid
        self.held = np.where(heard, self.beacon[i].parts[0] - self.beacon[i].parts[1], self.held)
        self.seen_at = np.where(here, self.time, self.seen_at)
        self.updates = self.updates + np.where(here, 1, 0)
        self.farthest = np.maximum(self.farthest, np.max(self.beacon.range))
        self.drawn = np.where(here, noise(1)[0], self.drawn)


class Grid(Component):
    """Bundles in rows and columns."""

    cell = Bundle((2, 3), value=Input("1", description="value"), description="cell")
    back = Bundle((2, 3), value=Output("1", description="value, rows and columns exchanged in what is added"))
    sample_period = Parameter("s", start=0.1, min=1e-3, description="sampling period")

    @on_new("cell")
    def take(self, row, column):
        self.back[row][column].publish(value=self.cell[row, column].value + 10.0 * column + row)

    @every("sample_period")
    def tick_only(self):
        pass


def bank(count, states):
    """Return a component: ``count`` Kalman filters of ``states`` states, packed, each with its own measurement."""
    rows, columns = np.triu_indices(states)
    place = np.zeros((states, states), int)
    place[rows, columns] = place[columns, rows] = np.arange(len(rows))
    moved = np.eye(states) + 0.1 * np.eye(states, k=1)
    seen = np.cos(np.arange(states))

    def predict(x, packed):
        return moved @ x, (moved @ packed[place] @ moved.T + 0.01 * np.eye(states))[rows, columns]

    def update(x, packed, z, variance):
        covariance = packed[place]
        gain = covariance @ seen / (seen @ covariance @ seen + variance)
        return x + gain * (z - seen @ x), (covariance - np.outer(gain, seen @ covariance))[rows, columns]

    class Bank(Component):
        """A bank of filters."""

        name = f"bank_{count}_{states}"
        z = Input(count, "1", description="measurement of each")
        variance = Parameter(count, "1", start=1.0 + np.arange(count), min=1e-3, description="its variance")
        sample_period = Parameter("s", start=0.1, min=1e-3, description="sampling period")
        x = State(count, states, "1", description="estimates")
        packed = State(count, len(rows), "1", start=np.eye(states)[rows, columns], description="covariances, packed")
        first = Output(count, "1", description="first estimate of each")
        sigma = Output(count, "1", description="its standard deviation")

        @every("sample_period")
        def step(self):
            found = []
            for i in range(count):
                x, packed = predict(self.x[i], self.packed[i])
                found.append(update(x, packed, self.z[i], self.variance[i]))
            self.x, self.packed = (np.stack(parts) for parts in zip(*found, strict=True))
            self.first, self.sigma = self.x[:, 0], np.sqrt(self.packed[:, 0])

    Bank.moved, Bank.seen = moved, seen
    return Bank


def corrected(x, covariance, seen, value):
    """Correct an estimate of eight states by a measurement along ``seen``."""
    gain = covariance @ seen / (seen @ covariance @ seen + 1.0)
    return x + gain * (value - seen @ x), covariance - np.outer(gain, seen @ covariance)


def listener(count):
    """Return a component that estimates eight states by what ``count`` stations send, one task for each."""

    class Listening(Component):
        """Estimates by what many stations send."""

        name = f"listener_{count}"
        tick = "sample_period"
        station = Bundle(count, seen=Input(8, "1", description="row"), value=Input("1", description="measurement"))
        sample_period = Parameter("s", start=0.1, min=1e-3, description="sampling period")
        x = Output(8, "1", description="estimate")
        covariance = State(8, 8, "1", start=np.eye(8), description="its covariance")

        @on_new("station")
        def take(self, i):
            self.x, self.covariance = corrected(self.x, self.covariance, self.station[i].seen, self.station[i].value)

    return Listening
