"""The smooth flight behind a recorded track.

Model: the horizontal and the vertical acceleration are first-order Gauss-Markov processes, so a flight p(t) costs

    integral of (tau/(2 sigma^2)) |p'''|^2 + (1/(2 sigma^2 tau)) |p''|^2 dt,

a recorded position is p(t_i + d_i) + noise with a time error d_i ~ N(0, sigma_t^2) of its own, and recorded speed,
track and vertical rate measure p'(t_i). The least-squares flight is what a Rauch-Tung-Striebel smoother would return;
here it is found at once as a spline of degree five by sparse normal equations, repeated with the weights of a Student
t distribution so that single wrong rows lose their say. Latitude, longitude and altitude are themselves the splines,
so their derivatives are exact everywhere, and the fourth is still continuous.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy import sparse
from scipy.interpolate import BSpline
from scipy.sparse.linalg import splu

from navfmu.constants import FOOT, KNOT
from navfmu.recorded.defects import local_metric, wrap
from navfmu.recorded.track import Recording

DEGREE = 5
FREEDOM = 4.0  # of the Student t distribution of the residuals
ITERATIONS = 12
LOOSE, TIGHTEN = 5.0, 0.6  # the first iteration believes positions less, so that a stale start does not win by itself
HALF_KNOWN = 4.0  # factor on the deviation of a speed that somebody interpolated, and twice that of an altitude


@dataclass(frozen=True)
class Noise:
    """Standard deviations of the measurements, SI."""

    position: float = 15.0
    time: float = 0.05
    speed: float = 3.0 * KNOT
    track: float = np.radians(5.0)
    altitude: float = 25.0 * FOOT
    climb: float = 150.0 * FOOT / 60.0


@dataclass(frozen=True)
class Manoeuvre:
    """The Gauss-Markov accelerations of the flight: standard deviation in m/s2 and correlation time in s."""

    horizontal: float = 1.5
    vertical: float = 0.5
    time: float = 10.0


@dataclass(frozen=True)
class Flight:
    """Splines of latitude, longitude (rad) and altitude (m) over the seconds since the start."""

    start: float  # of the recording's clock, s
    duration: float
    spacing: float
    latitude: BSpline
    longitude: BSpline
    altitude: BSpline

    def table(self) -> np.ndarray:
        """Rows of (time, position[3], its first derivative[3], its second derivative[3]) at the knots.

        Two neighbouring rows determine the polynomial of degree five between them, so nothing is lost.
        """
        time = np.arange(round(self.duration / self.spacing) + 1) * self.spacing
        axes = (self.latitude, self.longitude, self.altitude)
        return np.column_stack([time, *(axis(time, order) for order in range(3) for axis in axes)])

    def velocity(self, time: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """North, east and up, m/s."""
        north, east = local_metric(self.latitude(time), self.altitude(time))
        return north * self.latitude(time, 1), east * self.longitude(time, 1), self.altitude(time, 1)


@dataclass(frozen=True)
class Residuals:
    """Recorded minus smoothed, one value per row; NaN where the row holds no such measurement."""

    time: np.ndarray  # s since the start
    along: np.ndarray  # m, positive ahead
    cross: np.ndarray  # m, positive right
    timing: np.ndarray  # s, the time error that the smoothing ascribes to the row
    altitude: np.ndarray  # m
    speed: np.ndarray  # m/s
    track: np.ndarray  # rad
    climb: np.ndarray  # m/s


class _Basis:
    """B-splines on even knots that reach past both ends, and their derivatives, as sparse matrices."""

    def __init__(self, duration: float, spacing: float):
        self.intervals = max(4, int(np.ceil(duration / spacing - 1e-9)))
        self.spacing = duration / self.intervals
        self.knots = (np.arange(-DEGREE, self.intervals + DEGREE + 1)) * self.spacing
        self.size = self.intervals + DEGREE
        self.duration = duration

    def matrix(self, time: np.ndarray, order: int = 0) -> sparse.csr_matrix:
        time = np.clip(time, 0.0, self.duration)
        degree = DEGREE - order
        inner = self.knots[order : len(self.knots) - order]
        if len(time) == 0:
            return sparse.csr_matrix((0, self.size))
        values = BSpline.design_matrix(time, inner, degree, extrapolate=False)
        for k in range(order):
            n = self.size - order + k  # columns of values; the next difference has one more
            difference = sparse.diags([-1.0, 1.0], [0, 1], shape=(n, n + 1)) / self.spacing
            values = values @ difference
        return sparse.csr_matrix(values)

    def quadrature(self) -> tuple[np.ndarray, np.ndarray]:
        """Gauss-Legendre points and weights, exact for the squared derivatives in the penalty."""
        x, w = np.polynomial.legendre.leggauss(4)
        left = np.arange(self.intervals) * self.spacing
        points = (left[:, None] + 0.5 * self.spacing * (x[None, :] + 1.0)).ravel()
        return points, np.tile(0.5 * self.spacing * w, self.intervals)

    def spline(self, coefficients: np.ndarray) -> BSpline:
        return BSpline(self.knots, coefficients, DEGREE, extrapolate=True)


def _penalty(basis: _Basis, sigma: float, tau: float, scale: np.ndarray | float = 1.0) -> sparse.csr_matrix:
    """Matrix P with c'Pc = the cost of the accelerations of a spline c whose unit is ``scale`` metres."""
    points, weights = basis.quadrature()
    weights = weights * np.square(scale)
    third, second = basis.matrix(points, 3), basis.matrix(points, 2)
    return (
        third.T @ sparse.diags(weights * tau / (2.0 * sigma**2)) @ third
        + second.T @ sparse.diags(weights / (2.0 * sigma**2 * tau)) @ second
    )


def _student(squared: np.ndarray, dimensions: int) -> np.ndarray:
    """Weight of a row whose squared normalised residual is ``squared``."""
    return (FREEDOM + dimensions) / (FREEDOM + squared)


def _solve(normal: sparse.spmatrix, right: np.ndarray) -> np.ndarray:
    scale = 1.0 / np.sqrt(normal.diagonal())  # equilibrated: the penalty spans many powers of ten
    balanced = sparse.diags(scale) @ normal @ sparse.diags(scale)
    return scale * splu(sparse.csc_matrix(balanced)).solve(scale * right)


def smooth(
    recording: Recording,
    measured: np.ndarray,
    known: np.ndarray,
    alive: np.ndarray,
    noise: Noise,
    manoeuvre: Manoeuvre | None = None,
    spacing: float | None = None,
) -> tuple[Flight, Residuals]:
    """Fit the flight to the rows of a recording.

    ``measured`` marks the rows whose position and altitude are measurements, ``known`` those whose altitude and speed
    are at least interpolations between measurements, ``alive`` those whose speed, track and vertical rate are measured.
    ``spacing`` of the knots in s; by default that of the rows, between half a second and five.
    """
    manoeuvre = manoeuvre or Manoeuvre()
    start = recording.time[0]
    time = recording.time - start
    spacing = spacing or float(np.clip(np.median(np.diff(time)), 0.5, 5.0))
    basis = _Basis(float(time[-1]), spacing)
    vertical, altitude_residual, climb_residual = _smooth_vertical(
        recording, measured, known, alive, noise, manoeuvre, basis
    )
    latitude, longitude, residuals = _smooth_horizontal(
        recording, measured, known, alive, noise, manoeuvre, basis, vertical
    )
    flight = Flight(float(start), basis.duration, basis.spacing, latitude, longitude, vertical)
    return flight, Residuals(time, *residuals[:3], altitude_residual, *residuals[3:], climb_residual)


def _smooth_vertical(recording, measured, known, alive, noise, manoeuvre, basis):
    time = recording.time - recording.time[0]
    penalty = _penalty(basis, manoeuvre.vertical, manoeuvre.time)
    rows = np.flatnonzero(known)
    deviation = noise.altitude * np.where(measured[rows], 1.0, 2.0 * HALF_KNOWN)
    value = basis.matrix(time[rows])
    climb_rows = _finite(recording.climb, alive)
    rate = basis.matrix(time[climb_rows], 1)
    offset = recording.altitude[rows[0]]
    height = recording.altitude[rows] - offset
    climb = recording.climb[climb_rows] if len(climb_rows) else np.zeros(0)
    weight, climb_weight = np.ones(len(rows)), np.ones(len(climb_rows))
    # the smoothest way through a hole over a runway may lead underground: never below the lowest recorded altitude
    knots = basis.matrix(np.linspace(0.0, basis.duration, basis.intervals + 1))
    lowest, stop = height.min(), np.zeros(basis.intervals + 1)
    for _ in range(ITERATIONS):
        w, wc = weight / deviation**2, climb_weight / noise.climb**2
        normal = penalty + value.T @ sparse.diags(w) @ value + rate.T @ sparse.diags(wc) @ rate
        normal = normal + knots.T @ sparse.diags(stop) @ knots
        c = _solve(normal, value.T @ (w * height) + rate.T @ (wc * climb) + knots.T @ (stop * lowest))
        stop = np.where(knots @ c < lowest - 1.0, 1.0, stop)
        error, climb_error = height - value @ c, climb - rate @ c
        weight = _student((error / deviation) ** 2, 1)
        climb_weight = _student((climb_error / noise.climb) ** 2, 1)
    return (
        basis.spline(c + offset),
        _spread(len(time), rows, error),
        _spread(len(time), climb_rows, climb_error),
    )


def _smooth_horizontal(recording, measured, known, alive, noise, manoeuvre, basis, vertical):
    time = recording.time - recording.time[0]
    n = basis.size
    rows = np.flatnonzero(measured)
    origin = np.array([recording.latitude[rows[0]], recording.longitude[rows[0]]])
    unit = np.array([float(m) for m in local_metric(origin[0], 0.0)])  # metres per radian at the origin
    # positions in even units of about a metre; the true metric at each place divides by that of the origin
    z = np.stack([recording.latitude[rows] - origin[0], recording.longitude[rows] - origin[1]]) * unit[:, None]

    def metric(at):
        latitude = np.interp(at, time[rows], recording.latitude[rows])
        return np.stack(local_metric(latitude, vertical(at))) / unit[:, None]

    points, _ = basis.quadrature()
    scale = metric(points)
    penalty = sparse.block_diag(
        [_penalty(basis, manoeuvre.horizontal, manoeuvre.time, scale[axis]) for axis in range(2)]
    )

    track_rows = _finite(recording.track, alive)
    speed_rows = _finite(recording.speed, known)
    speed_deviation = noise.speed * np.where(alive[speed_rows], 1.0, HALF_KNOWN)
    here, at_speed, at_track = metric(time[rows]), metric(time[speed_rows]), metric(time[track_rows])
    speed_basis, track_basis = basis.matrix(time[speed_rows], 1), basis.matrix(time[track_rows], 1)
    speed = recording.speed[speed_rows] if len(speed_rows) else np.zeros(0)
    track = recording.track[track_rows] if len(track_rows) else np.zeros(0)

    def pair(matrix, north, east):
        """Rows that measure north * x + east * y of the two splines."""
        return sparse.hstack([sparse.diags(north) @ matrix, sparse.diags(east) @ matrix])

    shift = np.zeros(len(rows))  # time error of each row
    weight = _lonely_weight(time[rows], z)
    speed_weight, track_weight = np.ones(len(speed_rows)), np.ones(len(track_rows))
    c = None
    for iteration in range(ITERATIONS):
        deviation = noise.time * max(1.0, LOOSE * TIGHTEN**iteration)
        value = basis.matrix(time[rows] + shift)
        if c is None:  # no direction yet: velocities as recorded, the same variance in all directions
            w = weight / (noise.position**2 + (deviation * 100.0) ** 2)
            both, in_speed, in_track = np.intersect1d(speed_rows, track_rows, return_indices=True)
            rate, wv = basis.matrix(time[both], 1), np.full(len(both), 1.0 / (6.0 * noise.speed) ** 2)
            recorded = speed[in_speed] * np.stack([np.cos(track[in_track]), np.sin(track[in_track])])
            normal, right = penalty, np.zeros(2 * n)
            for axis in range(2):
                a = pair(value, here[0] * (axis == 0), here[1] * (axis == 1))
                b = pair(rate, at_track[0][in_track] * (axis == 0), at_track[1][in_track] * (axis == 1))
                normal = normal + a.T @ sparse.diags(w) @ a + b.T @ sparse.diags(wv) @ b
                right = right + a.T @ (w * here[axis] * z[axis]) + b.T @ (wv * recorded[axis])
        else:
            velocity = np.stack([here[k] * (basis.matrix(time[rows] + shift, 1) @ c[k]) for k in range(2)])
            v = np.maximum(np.hypot(*velocity), 1.0)
            ahead = velocity / v
            along_variance = noise.position**2 + (v * deviation) ** 2
            a = pair(value, ahead[0] * here[0], ahead[1] * here[1])
            b = pair(value, -ahead[1] * here[0], ahead[0] * here[1])
            wa, wb = weight / along_variance, weight / noise.position**2
            # a row is at p(t + d); its prior d ~ N(0, sigma_t^2) pulls along the track back to d = 0
            za = ahead[0] * here[0] * z[0] + ahead[1] * here[1] * z[1] + v * shift
            zb = -ahead[1] * here[0] * z[0] + ahead[0] * here[1] * z[1]
            normal = penalty + a.T @ sparse.diags(wa) @ a + b.T @ sparse.diags(wb) @ b
            right = a.T @ (wa * za) + b.T @ (wb * zb)
            if len(speed_rows):  # speed is the velocity along the present direction
                moving = np.stack([at_speed[k] * (speed_basis @ c[k]) for k in range(2)])
                unit_vector = moving / np.maximum(np.hypot(*moving), 1.0)
                s = pair(speed_basis, unit_vector[0] * at_speed[0], unit_vector[1] * at_speed[1])
                ws = speed_weight / speed_deviation**2
                normal = normal + s.T @ sparse.diags(ws) @ s
                right = right + s.T @ (ws * speed)
            if len(track_rows):  # nothing moves across the recorded direction
                moving = np.hypot(*(at_track[k] * (track_basis @ c[k]) for k in range(2)))
                s = pair(track_basis, -np.sin(track) * at_track[0], np.cos(track) * at_track[1])
                wt = track_weight / (noise.track * np.maximum(moving, 10.0)) ** 2
                normal = normal + s.T @ sparse.diags(wt) @ s
        c = _solve(normal, right).reshape(2, n)

        # residuals at the new flight, new time errors, new weights
        value, rate = basis.matrix(time[rows] + shift), basis.matrix(time[rows] + shift, 1)
        velocity = np.stack([here[k] * (rate @ c[k]) for k in range(2)])
        v = np.maximum(np.hypot(*velocity), 1.0)
        ahead = velocity / v
        error = np.stack([here[k] * (z[k] - value @ c[k]) for k in range(2)])
        along, cross = (ahead * error).sum(axis=0), ahead[0] * error[1] - ahead[1] * error[0]
        prior = along + v * shift  # distance from the place at the recorded time
        weight = _student(prior**2 / (noise.position**2 + (v * deviation) ** 2) + (cross / noise.position) ** 2, 2)
        gain = v * deviation**2 / (noise.position**2 + (v * deviation) ** 2)
        shift = np.clip(gain * prior, -4.0 * deviation, 4.0 * deviation)
        moving = np.stack([at_speed[k] * (speed_basis @ c[k]) for k in range(2)])
        speed_error = speed - np.hypot(*moving)
        speed_weight = _student((speed_error / speed_deviation) ** 2, 1)
        moving = np.stack([at_track[k] * (track_basis @ c[k]) for k in range(2)])
        track_error = wrap(track - np.arctan2(moving[1], moving[0]))
        track_weight = _student((track_error / noise.track) ** 2, 1) * (np.abs(track_error) < np.pi / 2)

    value = basis.matrix(time[rows])
    error = np.stack([here[k] * (z[k] - value @ c[k]) for k in range(2)])
    rate = basis.matrix(time[rows], 1)
    velocity = np.stack([here[k] * (rate @ c[k]) for k in range(2)])
    ahead = velocity / np.maximum(np.hypot(*velocity), 1.0)
    along, cross = (ahead * error).sum(axis=0), ahead[0] * error[1] - ahead[1] * error[0]
    m = len(time)
    residuals = (
        _spread(m, rows, along),
        _spread(m, rows, cross),
        _spread(m, rows, shift),
        _spread(m, speed_rows, speed_error),
        _spread(m, track_rows, track_error),
    )
    return basis.spline(c[0] / unit[0] + origin[0]), basis.spline(c[1] / unit[1] + origin[1]), residuals


def _lonely_weight(time: np.ndarray, z: np.ndarray) -> np.ndarray:
    """First weights of the positions z (m): small for one that lies far from where its two neighbours put it."""
    share = (time[1:-1] - time[:-2]) / (time[2:] - time[:-2])
    away = np.hypot(*(z[:, :-2] + share * (z[:, 2:] - z[:, :-2]) - z[:, 1:-1]))
    usual = 150.0 + 3.0 * (time[1:-1] - time[:-2]) * (time[2:] - time[1:-1])  # jitter, and a steep turn
    return np.r_[1.0, _student((away / usual) ** 2, 2), 1.0]


def _finite(column: np.ndarray | None, among: np.ndarray | bool = True) -> np.ndarray:
    """Rows in which the column, if there is one, holds a value."""
    return np.zeros(0, int) if column is None else np.flatnonzero(among & np.isfinite(column))


def _spread(size: int, rows: np.ndarray, values: np.ndarray) -> np.ndarray:
    out = np.full(size, np.nan)
    out[rows] = values
    return out
