"""The FMU ``dme``: airborne DME receiver and the transponders it ranges to."""

from __future__ import annotations

import numpy as np

from fmus import examples
from fmus.radio import grades, stations
from models.earth import earth
from models.processes import gauss_markov, places
from models.processes.known import known
from models.radio import dme, interrogator, schedule, sight, transponder
from navfmu.constants import NAUTICAL_MILE
from navfmu.export import (
    Bundle,
    Component,
    Example,
    Grid,
    Input,
    Output,
    Parameter,
    State,
    Table,
    every,
    require,
    start,
)
from navfmu.repetition import repeat

PLACES = stations.PLACES
NETWORK = 2
"""Of ``stations_from``."""
_ROUND = np.array([0.0, 2.0 * np.pi])


class Dme(stations.StationTable, Component):
    """DME receiver with up to five ground transponders: slant ranges by schedule, with coverage and errors.

    Ranges (thesis section 2.5.5 and 3.9, p. 69). The reading of each station is

        R_m = R + dR_b + dR_w                                                            (3.38)

    R: straight distance on the WGS-84 ellipsoid. dR_b: first-order Gauss-Markov bias of 0.17 nmi with the correlation
    time tau_r = 0.5 nmi / V, V the ground speed; one for each station, advanced on its own clock (`bias_period`), so
    that it does not depend on when ranges are measured; it starts from its stationary distribution. dR_w: white noise
    of 0.004 nmi, fresh for each reading. (Table 6.1 of the thesis prints 5 miles / V; the text and (3.38) have 0.5
    nmi)

    Schedule (Fig 2.10, section 7.2.2), by `mode`:

    - 1 intermittent: one receiver; every `interval` it has measured one station, the stations take turns. To do so it
      is tuned to the station for `lock_in` + `ranging_time` before, and the station must answer all that time.
    - 2 two-receiver: two receivers, two stations at the same time every `interval` (with more than two stations, pairs
      take turns).
    - 3 scanning: every station every `ranging_period`, once it has been locked in.

    A range is reported at the end of its ranging second and its time of validity is that moment. At each time a
    measurement is due the bundle is published, with `measured` saying which stations gave one; `valid` is false when
    none did.

    Which stations take turns, by `selection`: all of them, the `pair`, or the pair in reach whose lines cross nearest
    to a right angle, from `least_inclusion` on. It is chosen anew after each `interval`; stations nearer than
    `nearest` or higher above the station's level than `highest_elevation` are left out.

    Stations are the five of the parameters, or with `stations_from` five of the table `network` (AGARD CP-298 (1981),
    Brokof and Hurrass): each `exchange_period` those that the aircraft has left behind, out of range or below the radio
    horizon, give their places to the nearest others in reach. A station that is new in a place is locked in anew and
    has a bias of its own; its constant part is as before when it comes again. `station_number` ... say which they are.

    Interrogator (section 2.5.5). A receiver that is tuned to a station searches, with 135 pulse pairs a second, until
    it has had replies for `lock_in`, and then tracks with 25; a scanning one divides them among its stations. It has
    replies while at least `least_replies` of its interrogations are answered, on average over `reply_window`, and where
    it looks for them: what jumps by more than `gate` is lost and searched for. Where replies fail it waits for
    `memory_time`, showing the last range, before it searches.

    Transponder. It answers after 50 us while it is nearer than `station_range`, above the radio horizon (4/3 earth)
    and the `terrain`, on the air, and while its delay is less than `monitor_limit` wrong. It hears
    1 / (1 + rate `dead_time`) of what it and the other aircraft (`traffic`) ask, and gives `capacity` replies at most.

    With `receiver_share` that part of the variance of dR_b is the receiver's and common to all stations. The
    constant dR_0 of (3.38) is calibrated to 0 in the thesis; `receiver_offset` and `station_offset_sigma` leave some.

    Not modelled: the pulses themselves, garbling, and that a transponder in need answers the stronger ones.
    """

    parameter_sets = grades.DME

    example = Example(
        text="Level flight to the west at 90 kn with one receiver. It measures the two stations in turn, one every "
        "15 s, and the bundle holds the last range of each, so between measurements the ranges (steps) stay behind the "
        "truth (dashed). The error of each measurement is the bias, 315 m (1 sigma), forgotten within 20 s.",
        duration=300.0,
        step=0.5,
        inputs=examples.dme_inputs,
        shows=("ranging.sequence", "ranging.valid"),
        panels=examples.dme_panels,
    )

    latitude = Input("rad", display_unit="deg", description="true geodetic latitude")
    longitude = Input("rad", display_unit="deg", description="true longitude")
    altitude = Input("m", display_unit="ft", description="true height above the ellipsoid, positive up")
    velocity_n = Input(
        3,
        "m/s",
        display_unit="kn",
        description="true velocity over ground: north, east, down; sets the correlation time",
    )
    traffic = Input(PLACES, "1", description="other aircraft that use each transponder (100 are its capacity)")
    station_off = Input(
        PLACES, kind="boolean", fault=True, description="fault: this transponder is off the air and does not answer"
    )
    replies_lost = Input(
        PLACES, "1", fault=True, description="fault: share of the replies of each station that is lost, 0 to 1"
    )
    wrong_station = Input(
        PLACES,
        kind="boolean",
        fault=True,
        description="fault: another station of the same channel, that at other_latitude, is heard instead of this one",
    )
    echo = Input(
        PLACES,
        "m",
        display_unit="nmi",
        fault=True,
        description="fault: replies come by a reflected path, longer by this, the direct one being hidden",
    )
    delay_change = Input(PLACES, "s", fault=True, description="fault: error of the 50 us delay of each transponder")
    delay_drift = Input(
        PLACES,
        "1",
        fault=True,
        description="fault: rate in s/s at which the delay of each transponder runs away while this is not 0",
    )

    mode = Parameter(
        kind="integer",
        start=1,
        min=1,
        max=3,
        description="receiver: 1 intermittent (one receiver), 2 two-receiver, 3 scanning (thesis section 7.2.2)",
    )
    station_range = Parameter(
        PLACES,
        "m",
        start=stations.UNLIMITED * NAUTICAL_MILE,
        min=0.0,
        display_unit="nmi",
        description="service range of each transponder; it does not answer beyond",
    )
    antenna_height = Parameter(
        "m", start=10.0, min=0.0, max=500.0, description="height of the transponders' antennas, for the radio horizon"
    )
    terrain = Grid(
        axes=(("station", "1", np.arange(1.0, PLACES + 1.0)), ("azimuth", "rad", _ROUND)),
        surfaces=(("mask", "rad", np.full((PLACES, 2), -0.5 * np.pi)),),
    )
    other_latitude = Parameter(
        "rad",
        start=np.radians(37.2),
        min=-np.pi / 2,
        max=np.pi / 2,
        display_unit="deg",
        description="latitude of another station of the same channel, for wrong_station (hypothetical)",
    )
    other_longitude = Parameter(
        "rad",
        start=np.radians(-120.9),
        min=-np.pi,
        max=np.pi,
        display_unit="deg",
        description="longitude of that station",
    )
    other_altitude = Parameter(
        "m", start=30.0, min=-1000.0, max=10000.0, display_unit="ft", description="height of that station"
    )
    stations_from = Parameter(
        items=("places", "network"),
        kind="enumeration",
        description="where stations come from: the five of the parameters, or five at a time of the table network",
    )
    network = Table(columns=stations.NETWORK_COLUMNS, rows=stations.network(stations.BAY_AREA.stations))
    exchange_period = Parameter(
        "s",
        start=10.0,
        min=0.01,
        max=3600.0,
        description="how often stations of the network that are out of reach give their places to others (own choice)",
    )
    selection = Parameter(
        items=("all", "pair", "inclusion_angle"),
        kind="enumeration",
        description="which stations take turns: all, the pair, or the pair that crosses best where the aircraft is",
    )
    pair = Parameter(
        2, kind="integer", start=(1, 2), min=1, max=PLACES, description="places of the two stations of a fixed pair"
    )
    least_inclusion = Parameter(
        "rad",
        start=np.radians(30.0),
        min=0.0,
        max=np.pi / 2,
        display_unit="deg",
        description="least angle between the lines to two stations, and to 180 deg (FAA AC 90-100A: 30 to 150 deg)",
    )
    nearest = Parameter(
        "m",
        start=0.0,
        min=0.0,
        display_unit="nmi",
        description="stations nearer than this are not used (RNAV practice: 3 nmi)",
    )
    highest_elevation = Parameter(
        "rad",
        start=np.pi / 2,
        min=0.0,
        max=np.pi / 2,
        display_unit="deg",
        description="aircraft higher above the level of a station than this does not use it (RNAV practice: 40 deg)",
    )
    retry_time = Parameter(
        "s",
        start=60.0,
        min=0.0,
        description="how long a station that did not answer is not selected by inclusion angle (own choice)",
    )
    interval = Parameter(
        "s",
        start=15.0,
        min=1.0,
        max=3600.0,
        description="time between measurements in modes 1 and 2; 15 s by the transponders' capacity (thesis Fig 2.10)",
    )
    lock_in = Parameter(
        "s", start=dme.LOCK_IN, min=0.0, max=60.0, description="tracking before a range can be taken (thesis Fig 2.10)"
    )
    ranging_time = Parameter(
        "s", start=dme.RANGING, min=0.0, max=60.0, description="duration of ranging after lock-in (thesis Fig 2.10)"
    )
    ranging_period = Parameter(
        "s",
        start=1.0,
        min=0.01,
        max=60.0,
        description="time step of the receiver; period of mode 3 (thesis section 7.3)",
    )
    memory_time = Parameter(
        "s",
        start=0.0,
        min=0.0,
        max=120.0,
        description="how long the last range is shown when replies fail after lock-in; receivers have up to some 10 s",
    )
    gate = Parameter(
        "m",
        start=0.5 * NAUTICAL_MILE,
        min=1.0,
        display_unit="nmi",
        description="replies that jump by more than this, and 1000 kn, are lost and searched for (own choice)",
    )
    least_replies = Parameter(
        "1", start=0.5, min=0.0, max=1.0, description="least share of replies with which lock is kept (own choice)"
    )
    reply_window = Parameter(
        "s", start=2.0, min=0.01, max=60.0, description="time over which replies are averaged (own choice)"
    )
    reply_efficiency = Parameter(
        PLACES, "1", start=1.0, min=0.0, max=1.0, description="share that each transponder answers of what it hears"
    )
    capacity = Parameter(
        PLACES,
        "Hz",
        start=transponder.CAPACITY,
        min=1.0,
        description="pulse pairs a second that each transponder can give (thesis section 2.5.5: 3000)",
    )
    dead_time = Parameter(
        "s",
        start=transponder.DEAD_TIME,
        min=0.0,
        max=1e-3,
        description="time for which a transponder is deaf after what it has heard: 60 us",
    )
    searching_share = Parameter(
        "1",
        start=transponder.SEARCHING_SHARE,
        min=0.0,
        max=1.0,
        description="share of the other aircraft that search (thesis section 2.5.5: 5 of 100)",
    )
    monitor_limit = Parameter(
        "s",
        start=transponder.MONITOR_LIMIT,
        min=0.0,
        max=1.0,
        description="error of the delay from which on its monitor takes a station off the air (ICAO Annex 10: 1 us)",
    )
    precise = Parameter(
        PLACES,
        kind="boolean",
        start=False,
        description="station and receiver are DME/P: within 7 nmi dR_b is (30 m + 11 m a nmi) / 2 over 0.17 nmi of it",
    )
    receiver_share = Parameter(
        "1",
        start=0.0,
        min=0.0,
        max=1.0,
        description="share of the variance of dR_b that is the receiver's, common to all stations (thesis p. 72: more "
        "likely its cause); ICAO Annex 10 gives it 315 m of 370 m, 0.72",
    )
    receiver_offset = Parameter(
        "m", start=0.0, display_unit="nmi", description="constant part of dR_0 (3.38) that is the receiver's"
    )
    station_offset_sigma = Parameter(
        "m",
        start=0.0,
        min=0.0,
        display_unit="nmi",
        description="standard deviation of each station's constant part of dR_0 (3.38), drawn at start",
    )
    bias_sigma = Parameter(
        "m",
        start=dme.BIAS_SIGMA,
        min=0.0,
        display_unit="nmi",
        description="standard deviation of the time-varying bias: 0.17 nmi (thesis (3.38), p. 72)",
    )
    correlation_distance = Parameter(
        "m",
        start=dme.CORRELATION_DISTANCE,
        min=1.0,
        display_unit="nmi",
        description="distance over which the bias is correlated: 0.5 nmi (thesis (3.38), p. 72)",
    )
    lowest_speed = Parameter(
        "m/s", start=5.0, min=0.1, description="least ground speed used in the correlation time 0.5 nmi / V"
    )
    noise_sigma = Parameter(
        "m",
        start=dme.NOISE_SIGMA,
        min=0.0,
        display_unit="nmi",
        description="standard deviation of the wide-band noise: 0.004 nmi (thesis Fig 3.13, (3.38))",
    )
    bias_period = Parameter("s", start=0.5, min=0.001, max=10.0, description="time step of the biases, own clock")

    ranging = Bundle(
        slant_range=Output(PLACES, "m", display_unit="nmi", description="measured distance, where `measured`"),
        measured=Output(PLACES, kind="boolean", description="whether this range was measured at the time of validity"),
        description="DME ranges",
    )
    phase = Output(
        PLACES,
        kind="integer",
        start=int(interrogator.Phase.IDLE),
        description="what was done about each station in the last step: 1 nothing, 2 search, 3 track, 4 memory",
    )
    interrogation_rate = Output(
        PLACES, "Hz", description="pulse pairs a second with which each station was asked in it"
    )
    answered_share = Output(PLACES, "1", description="share of interrogations that each station answers")

    station_number = Output(
        PLACES, kind="integer", description="which station of the parameters or of the network is in each place, 0 none"
    )
    place_latitude = Output(PLACES, "rad", display_unit="deg", description="geodetic latitude of that station")
    place_longitude = Output(PLACES, "rad", display_unit="deg", description="longitude of it")
    place_altitude = Output(PLACES, "m", display_unit="ft", description="height of it above the ellipsoid")

    placed = State(PLACES, kind="integer", description="number of the station in each place, 0: none")
    placed_at = State((4, PLACES), "1", description="latitude, longitude (rad), altitude and range (m) of that station")
    placed_e = State((3, PLACES), "m", description="position of it in e")
    placed_sines = State((4, PLACES), "1", description="sine and cosine of its latitude and of its longitude")
    placed_horizon = State(PLACES, "m", description="distance of the radio horizon of its antenna")
    network_offset = State(stations.NETWORK, "m", description="constant bias of each station of the network")
    bias = State(PLACES, "m", description="time-varying bias dR_b of each station (3.38)")
    station_bias = State(PLACES, "m", description="process of each station, of bias_sigma")
    receiver_bias = State("m", description="process of the receiver, of bias_sigma")
    offset = State(PLACES, "m", description="constant bias dR_0 of each station (3.38)")
    delay_drifted = State(PLACES, "s", description="what delay_drift has come to")
    selected = State(PLACES, kind="boolean", description="stations that take turns")
    rest = State(PLACES, "s", description="for how long each station is not selected because it did not answer")
    tracking = State(PLACES, "s", description="how long each station has been asked and has answered without a break")
    searching = State(PLACES, "s", description="how long each station has been searched for")
    luck = State(PLACES, "1", description="how far the average of replies is off, in standard deviations")
    silent = State(PLACES, "s", description="since when each station has not answered")
    followed = State(PLACES, "m", description="distance at which replies were last followed")
    held = State(PLACES, "m", description="last reading of each station, for its memory")

    @require(
        "interval {interval} s is shorter than lock_in {lock_in} s plus ranging_time {ranging_time} s, in whole steps "
        "of ranging_period {ranging_period} s"
    )
    def interval_is_long_enough(self):
        whole = np.floor(self.interval / self.ranging_period + 1.0e-9) * self.ranging_period
        return (self.mode == 3) | ((whole > 0.0) & (whole >= self.lock_in + self.ranging_time - 1.0e-9))

    @require("pair does not name two different places, from 1 to station_count {station_count}")
    def pair_is_there(self):
        there = np.all(self.pair <= self.station_count) & (self.pair[0] != self.pair[1])
        return (self.selection != 2) | there

    @require("network has stations beyond the 32 that can be chosen from, or not numbered from 1 on")
    def network_is_numbered(self):
        ends = self.network.around(number=np.array([0.0, np.inf]))
        return (ends.row[0, 0] == 1.0) & (ends.next_row[1, 0] <= stations.NETWORK)

    @require("network has places beyond pi/2 or pi; expected latitudes and longitudes in rad, not degrees")
    def network_is_in_rad(self):
        _, latitude, longitude, _, _ = self.of_network(np.arange(1, stations.NETWORK + 1))
        return np.all((np.abs(latitude) <= 0.5 * np.pi + 1e-9) & (np.abs(longitude) <= np.pi + 1e-9))

    @require("network has a number that is not whole, a height beyond -1000 to 10000 m, or a range that is none")
    def network_is_possible(self):
        around = self.network.around(number=np.arange(1.0, stations.NETWORK + 1.0))
        number, _, _, altitude, reach = np.concatenate([around.row, around.next_row]).T
        return np.all((number == np.floor(number)) & (altitude >= -1000.0) & (altitude <= 10000.0) & (reach > 0.0))

    @require("terrain does not reach around: expected azimuths from 0 to 2 pi rad and stations from 1 to 5")
    def terrain_reaches_around(self):
        stations, azimuths = self.terrain.around(station=np.array([1.0, PLACES]), azimuth=_ROUND).ends
        around = (azimuths[0, 0] <= 0.0) & (np.abs(azimuths[1, 1] - 2.0 * np.pi - 0.05) <= 0.05 + 1e-6)
        return around & (stations[0, 0] <= 1.0) & (stations[1, 1] >= PLACES)

    @require("terrain has masks of more than pi/2 rad in size; expected elevations in rad, not degrees")
    def terrain_is_in_rad(self):
        stations, azimuths = np.meshgrid(np.arange(1.0, PLACES + 1.0), np.radians(np.arange(0.0, 360.0, 10.0)))
        masks = self.terrain.around(station=stations.ravel(), azimuth=azimuths.ravel()).bilinear()
        return np.all(np.abs(masks) <= 0.5 * np.pi + 1e-9)

    @start
    def draw_biases(self, noise):
        self.station_bias = gauss_markov.stationary(self.bias_sigma, noise(PLACES))
        self.receiver_bias = gauss_markov.stationary(self.bias_sigma, noise(1)[0])
        self.bias = dme.shared(self.station_bias, self.receiver_bias, self.receiver_share)
        self.offset = self.receiver_offset + self.station_offset_sigma * noise(PLACES)
        self.luck = gauss_markov.stationary(1.0, noise(PLACES))
        self.network_offset = self.receiver_offset + self.station_offset_sigma * noise(stations.NETWORK)

    @every("bias_period")
    def advance_biases(self, noise):
        tau = dme.correlation_time(known(self.velocity_n, 0.0), self.lowest_speed, self.correlation_distance)
        phi = gauss_markov.decay(self.period, tau)
        driving = gauss_markov.drive(self.bias_sigma, phi)
        self.station_bias = gauss_markov.advance(self.station_bias, phi, driving, noise(PLACES))
        self.receiver_bias = gauss_markov.advance(self.receiver_bias, phi, driving, noise(1)[0])
        self.bias = dme.shared(self.station_bias, self.receiver_bias, self.receiver_share)

    def of_network(self, number):
        """Whether the network has stations of these numbers; latitude, longitude, altitude and range of them."""
        around = self.network.around(number=1.0 * number)
        found = np.where((around.next_row[:, 0] == number)[:, None], around.next_row, around.row)
        there, latitude, longitude, altitude, reach = found.T
        return there == number, latitude, longitude, altitude, reach

    def located(self, latitude, longitude, altitude, reach):
        """What is kept about stations: it changes with them and not with the aircraft."""
        return (
            np.stack([latitude, longitude, altitude, reach]),
            earth.to_ecef(latitude, longitude, altitude),
            np.stack(sight.sines(latitude, longitude)),
            dme.horizon_from(np.maximum(altitude, 0.0) + self.antenna_height),
        )

    def terrain_is_low(self):
        """Whether terrain hides nothing: masks that are -pi/2 all around, in one cell from azimuth 0 to 2 pi."""
        number, azimuth = np.meshgrid(np.arange(1.0, stations.NETWORK + 1.0), _ROUND, indexing="ij")
        around = self.terrain.around(station=number, azimuth=azimuth)
        first, last = around.ends[1][:, 0], around.ends[1][:, 1]
        return np.all(around.corners <= -0.5 * np.pi) & np.all(first == last)

    def visible(self, north, east, up, distance):
        """Stations that are not behind terrain, seen from them at north, east, up, m; without a row there is none."""
        number = np.maximum(1.0 * self.station_number, 1.0)

        def above_terrain(_):
            around = self.terrain.around(station=number, azimuth=sight.azimuth(north, east))
            mask = np.where(number <= around.ends[0][:, 1], around.bilinear()[:, 0], -0.5 * np.pi)
            return sight.is_above(up, distance, np.clip(mask - sight.bending(distance), -0.5 * np.pi, 0.5 * np.pi))

        flat = sight.is_above(up, distance, -0.5 * np.pi)
        return repeat(above_terrain, flat, np.where(self.terrain_is_low(), 0, 1), 1)

    def select(self, line, inside, admitted):
        """Stations that take turns from now on; ``line`` from each to the aircraft in e."""
        place = np.arange(PLACES)
        usable = admitted & inside & (self.rest <= 0.0)

        def crossing_best(_):
            north, east, _ = sight.in_n(self.latitude, self.longitude, line)
            return schedule.best_pair(north, east, usable, self.least_inclusion)

        in_pair = (place == self.pair[0] - 1) | (place == self.pair[1] - 1)
        named = admitted & ((self.selection == 1) | in_pair)
        due_before = schedule.due_now(self.time - self.period, self.period, self.interval)
        anew = due_before | ~np.any(self.selected)
        chosen = repeat(crossing_best, named, np.where(anew & (self.selection == 3), 1, 0), 1)
        return np.where(anew, chosen, self.selected)

    @every("ranging_period")
    def receive(self, noise):
        dwell = self.lock_in + self.ranging_time
        here = (self.latitude, self.longitude, self.altitude)
        self.station_number = self.placed
        self.place_latitude, self.place_longitude, self.place_altitude, service = self.placed_at
        line = earth.to_ecef(*here)[:, None] - self.placed_e
        north, east, up = sight.turned(self.placed_sines, line)
        true_range = np.sqrt(np.sum(line * line, axis=0))
        reach = np.minimum(dme.horizon_from(self.altitude) + self.placed_horizon, service)
        inside = (true_range <= reach) & self.visible(north, east, up, true_range)

        # whom to ask
        too_high = sight.is_above(up, true_range, self.highest_elevation)
        admitted = (self.station_number > 0) & (true_range >= self.nearest) & ~too_high
        self.selected = self.select(line, inside, admitted)
        asked, due, announced = schedule.asked(self.time, self.period, self.mode, self.interval, dwell, self.selected)
        rate = interrogator.rate(asked, self.tracking, self.searching, self.lock_in)
        among = np.where(self.mode == 3, np.maximum(np.sum(np.where(asked, 1.0, 0.0)), 1.0), 1.0)
        self.interrogation_rate = rate / among

        # who answers, and with what delay
        others = (np.array([x]) for x in (self.other_latitude, self.other_longitude, self.other_altitude))
        other_range = dme.slant_range(*here, *others)
        other_reach = dme.horizon(self.altitude, self.other_altitude, self.antenna_height)
        distance = np.where(self.wrong_station, other_range, true_range)
        self.delay_drifted = transponder.drifted(self.delay_drifted, known(self.delay_drift, 0.0), self.period)
        delay = np.where(self.wrong_station, 0.0, self.delay_change + self.delay_drifted)
        off = self.station_off | (np.abs(delay) >= self.monitor_limit)
        heard = np.where(self.wrong_station, other_range <= other_reach, inside & ~off)
        load = transponder.load(np.maximum(self.traffic, 0.0), self.searching_share) + self.interrogation_rate
        share = transponder.efficiency(load, self.capacity, self.dead_time) * self.reply_efficiency
        share = share * np.clip(1.0 - self.replies_lost, 0.0, 1.0)
        self.answered_share = known(np.where(heard, share, 0.0), 0.0)

        # what the receiver makes of it
        normal, replies = noise(PLACES), noise(PLACES)
        path = distance + transponder.range_of(delay) + self.echo
        gated = interrogator.in_gate(path, self.followed, self.gate, self.silent + self.period)
        phi = gauss_markov.decay(self.period, self.reply_window)
        self.luck = gauss_markov.advance(self.luck, phi, gauss_markov.drive(1.0, phi), replies)
        replied = interrogator.replied(self.answered_share, self.interrogation_rate, self.reply_window, self.luck)
        enough = (replied >= self.least_replies) & (self.answered_share > 0.0)
        answered = asked & enough & np.isfinite(path) & (gated | (self.tracking <= 0.0))
        self.silent = np.where(answered, 0.0, self.silent + self.period)
        waiting = ~answered & interrogator.remembered(asked, self.tracking, self.silent, self.lock_in, self.memory_time)
        kept = answered | waiting
        self.phase = interrogator.phase(asked, self.tracking, kept, waiting, self.lock_in)
        self.tracking = interrogator.tracking_time(self.tracking, kept, self.period)
        self.searching = np.where(self.phase == interrogator.Phase.SEARCH, self.searching + self.period, 0.0)
        self.followed = np.where(answered, path, self.followed)

        measured = due & admitted & kept & (self.tracking >= dwell - 1.0e-6)
        self.rest = np.where(
            due & ~measured & (self.searching >= dwell - 1.0e-6),
            self.retry_time,
            np.maximum(self.rest - self.period, 0.0),
        )
        precise = self.precise & (true_range < transponder.PRECISE_RANGE)
        finer = np.where(precise, transponder.precise_sigma(true_range) / dme.BIAS_SIGMA, 1.0)
        reading = dme.measure(path + self.offset, self.bias * finer, self.noise_sigma, normal)
        self.held = np.where(answered, reading, self.held)
        self.ranging.publish(
            slant_range=np.where(measured, self.held, self.ranging.slant_range),
            measured=measured,
            valid=np.any(measured),
            when=announced,
        )

    @every("exchange_period", offset="ranging_period")
    def exchange(self, noise):
        """Stations out of reach give their places to the nearest ones in reach, in the mode network."""
        number = np.arange(1, stations.NETWORK + 1)

        def exchanged(placed):
            there, latitude, longitude, altitude, most = self.of_network(number)
            away = dme.slant_range(self.latitude, self.longitude, self.altitude, latitude, longitude, altitude)
            reach = np.minimum(dme.horizon(self.altitude, altitude, self.antenna_height), most)
            inside = there & (away <= reach)
            kept = np.where(np.any((placed[:, None] == number) & inside, axis=1), placed, 0)
            return places.filled(kept, inside & np.logical_not(places.has_one(kept, stations.NETWORK)), away, PLACES)

        once = np.where(self.stations_from == NETWORK, 1, 0)
        placed = repeat(exchanged, self.placed, once, 1)
        new = placed != self.placed
        drawn = gauss_markov.stationary(self.bias_sigma, noise(PLACES))
        self.station_bias = np.where(new, drawn, self.station_bias)
        self.bias = dme.shared(self.station_bias, self.receiver_bias, self.receiver_share)
        here = placed[:, None] == number
        self.offset = np.where(new, np.sum(np.where(here, self.network_offset, 0.0), axis=1), self.offset)
        self.tracking = np.where(new, 0.0, self.tracking)
        self.searching = np.where(new, 0.0, self.searching)
        self.rest = np.where(new, 0.0, self.rest)
        self.selected = self.selected & np.logical_not(np.any(new))
        self.placed = placed
        self.placed_at, self.placed_e, self.placed_sines, self.placed_horizon = repeat(
            lambda _: self.located(*self.of_network(placed)[1:]),
            (self.placed_at, self.placed_e, self.placed_sines, self.placed_horizon),
            once,
            1,
        )

    @start
    def place_stations(self):
        """The stations of the parameters; a network has given away no place before the first exchange."""
        own = self.stations_from != NETWORK
        place = np.arange(1, PLACES + 1)
        self.placed = np.where(own & (place <= self.station_count), place, 0)
        where = (self.station_latitude, self.station_longitude, self.station_altitude, self.station_range)
        located = self.located(*(np.where(own, x, 0.0) for x in where))
        self.placed_at, self.placed_e, self.placed_sines, self.placed_horizon = located
