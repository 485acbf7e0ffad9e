"""The AHRS's filter once more, plainly: full matrices, derivatives by the complex step, from the equations alone.

It shares no code with ``models``. h and f are written as functions of the eleven quantities that are estimated,

    roll, pitch, heading | gyro biases | dip | hard iron over field strength | airspeed error,

and their derivatives are Im f(x + i eps) / eps, exact to rounding (Squire and Trapp, *SIAM Review* 40, 1998, p. 110).
"""

import numpy as np

G = 9.80665
EPS = 1e-30


def rotation(roll, pitch, heading):
    """C_bn = R1(roll) R2(pitch) R3(heading)."""
    c, s = np.cos, np.sin
    one, zero = roll * 0 + 1, roll * 0
    r1 = np.array([[one, zero, zero], [zero, c(roll), s(roll)], [zero, -s(roll), c(roll)]])
    r2 = np.array([[c(pitch), zero, -s(pitch)], [zero, one, zero], [s(pitch), zero, c(pitch)]])
    r3 = np.array([[c(heading), s(heading), zero], [-s(heading), c(heading), zero], [zero, zero, one]])
    return r1 @ r2 @ r3


def euler_rates(x, measured):
    p, q, r = measured - x[3:6]
    return np.array(
        [
            p + np.tan(x[1]) * (np.sin(x[0]) * q + np.cos(x[0]) * r),
            np.cos(x[0]) * q - np.sin(x[0]) * r,
            (np.sin(x[0]) * q + np.cos(x[0]) * r) / np.cos(x[1]),
        ]
    )


def tilt(x, measured_rate, indicated):
    """Lateral and longitudinal specific force over g, without the change of speed: w x V - g in b."""
    velocity = np.array([indicated - x[10], 0.0, 0.0])
    specific = np.cross(measured_rate - x[3:6], velocity) - rotation(*x[:3]) @ np.array([0.0, 0.0, G])
    return specific[[1, 0]] / G


def field(x, declination):
    c = np.cos(x[6])
    north = np.array([c * np.cos(declination), c * np.sin(declination), np.sin(x[6])])
    v = rotation(*x[:3]) @ north + x[7:10]
    return v / np.sqrt(v @ v)


def jacobian(function, x):
    return np.stack([np.imag(function(x + 1j * EPS * d)) / EPS for d in np.eye(len(x))], axis=1)


def wrap(angle):
    return (angle + np.pi) % (2 * np.pi) - np.pi


class Reference:
    """``parameters``: start values of the FMU's parameters by name."""

    def __init__(self, parameters):
        self.p = parameters
        self.x = np.zeros(11)
        self.covariance = np.zeros((11, 11))
        self.aligned, self.had_air = False, False
        self.indicated = self.p["airspeed"]
        self.declination, self.chart_sigma = self.p["declination"], None
        self.indicated_then, self.air_time_then = 0.0, 0.0
        self.last_rate, self.last_force, self.imu_time = np.zeros(3), np.array([0.0, 0.0, -G]), 0.0
        self.level = np.ones(2)
        self.sums, self.counts, self.window, self.misfit = np.zeros(2), np.zeros(2), 0.0, np.zeros(4)
        self.rates, self.forces, self.sideways, self.ahead = [], [], [], []

    def take_imu(self, rate, force, time):
        """Trapezoidal rule; the specific force of a sample belongs to the angles at its time."""
        previous = self.last_rate + self.x[3:6]
        y, x = self.last_force[[1, 0]] / G - tilt(self.x, previous, self.indicated)
        self.sideways.append(y)
        self.ahead.append(x)
        step = time - self.imu_time
        unbiased = rate - self.x[3:6]
        self.x[:3] += step * euler_rates(self.x, 0.5 * (self.last_rate + unbiased) + self.x[3:6])
        self.x[2] = wrap(self.x[2])
        self.rates.append(unbiased)
        self.forces.append(force)
        self.last_rate, self.last_force, self.imu_time = unbiased, force, time

    def look_up(self, chart):
        """``chart``: the magnetic model's result at the position; heading is known from magnetic north."""
        declination = np.radians(chart.d)
        if self.chart_sigma is None:
            self.x[2] = wrap(self.x[2] + declination - self.declination)
        self.declination = declination
        self.chart_sigma = np.radians(chart.calculate_uncertainty().d)

    def aid(self, now, period, air, field_sample):
        """``air``: (valid, airspeed, time, sigma) as last seen, ``field_sample``: (direction's field, time) or None."""
        p = self.p
        fresh = air[0] and now - air[2] <= p["air_timeout"] + 1e-6
        back = fresh and not self.had_air
        sigma_v = air[3] if fresh else p["blind_airspeed_sigma"]
        if back:
            self.x[10] = 0.0
            self.covariance[10, :] = self.covariance[:, 10] = 0.0
            self.covariance[10, 10] = sigma_v**2
        rate, force = np.mean(self.rates, axis=0), np.mean(self.forces, axis=0)
        changed = air[2] - self.air_time_then > 1e-6
        if self.aligned:
            self.predict(rate, period, sigma_v)
            correction = self.take_tilt(rate, fresh, changed, sigma_v, air)
        elif field_sample is not None:
            self.align(rate, force, fresh, sigma_v, field_sample)
            correction = np.zeros(11)
        if self.aligned and field_sample is not None:
            correction = self.take_field(rate, now, field_sample, correction)
        if self.aligned:
            self.x[:10] += correction[:10]
            self.x[10] = np.exp(-period / p["airspeed_time"]) * self.x[10] + correction[10]
            self.last_rate = self.last_rate - correction[3:6]
            self.x[2] = wrap(self.x[2])
        if self.window + period >= p["tilt_window"] - 1e-6:
            floor = (p["tilt_sigma_min"] / p["tilt_sigma"]) ** 2
            for axis in (0, 1):
                if self.counts[axis]:
                    seen = self.sums[axis] ** 2 / self.counts[axis]
                    gain = p["tilt_window"] / p["tilt_time"]
                    self.level[axis] = max(floor, (1 - gain) * self.level[axis] + gain * seen)
            self.sums, self.counts, self.window = np.zeros(2), np.zeros(2), 0.0
        elif self.aligned:
            self.window += period
        if self.misfit[3] * period >= p["field_window"] - 1e-6:
            self.misfit[:] = 0.0
        if not (fresh and self.had_air and not changed):
            self.ahead = []
        self.rates, self.forces, self.sideways = [], [], []
        self.indicated_then, self.air_time_then, self.had_air = self.indicated, air[2], fresh

    def align(self, rate, force, fresh, sigma_v, sample):
        p = self.p
        if fresh:
            force = force - np.cross(rate, [self.indicated, 0.0, 0.0])
        roll = np.arctan2(-force[1], -force[2])
        pitch = np.arctan2(force[0], np.hypot(force[1], force[2]))
        levelled = rotation(roll, pitch, 0.0).T @ (sample[0] / np.linalg.norm(sample[0]))
        self.x[:3] = roll, pitch, np.arctan2(-levelled[1], levelled[0]) + self.declination
        self.x[6] = np.arcsin(levelled[2])
        gyro = np.hypot(p["gyro_null_shift_sigma"], p["gyro_drift_sigma"])
        sigmas = [p["initial_sigma"]] * 2 + [1.0] + [gyro] * 3 + [p["dip_sigma"]] + [p["hard_iron_sigma"]] * 3
        self.covariance = np.diag(np.array([*sigmas, sigma_v]) ** 2)
        self.aligned = True

    def predict(self, rate, period, sigma_v):
        p = self.p
        phi = np.eye(11)
        phi[:3] += period * jacobian(lambda y: euler_rates(y, rate + self.x[3:6]), self.x)
        phi[10, 10] = np.exp(-period / p["airspeed_time"])
        gyro = (p["alpha"] * p["gyro_noise"]) ** 2 * p["sample_period"]
        noise = np.zeros(11)
        noise[:3] = period * (gyro + 60.0 * (p["gyro_scale_sigma"] * rate) ** 2)
        noise[3:6] = period * 2 * p["gyro_drift_sigma"] ** 2 / p["gyro_drift_time"]
        noise[6] = period * p["dip_walk"] ** 2
        noise[10] = sigma_v**2 * (1 - phi[10, 10] ** 2)
        self.covariance = phi @ self.covariance @ phi.T + np.diag(noise)

    def update(self, row, variance, residual, correction):
        gain = self.covariance @ row / (row @ self.covariance @ row + variance)
        correction = correction + gain * (residual - row @ correction)
        self.covariance = (np.eye(11) - np.outer(gain, row)) @ self.covariance
        self.covariance = 0.5 * (self.covariance + self.covariance.T)
        return correction

    def take_tilt(self, rate, fresh, changed, sigma_v, air):
        p = self.p
        sigma = p["tilt_sigma"] if fresh else p["blind_tilt_sigma"]
        rows = jacobian(lambda y: tilt(y, rate + self.x[3:6], self.indicated), self.x)
        speeding = (self.indicated - self.indicated_then) / (air[2] - self.air_time_then) if fresh and changed else 0.0
        residuals = np.mean(self.sideways), np.mean(self.ahead) - speeding / G
        correction = np.zeros(11)
        for axis, use in enumerate((True, not fresh or (self.had_air and changed))):
            if use:
                self.sums[axis] += (residuals[axis] - rows[axis] @ correction) / sigma
                self.counts[axis] += 1
                count = max(self.counts[axis], p["tilt_window"] / p["aiding_period"] / 3)
                self.level[axis] = max(self.level[axis], (self.sums[axis] / p["tilt_limit"]) ** 2 / count)
                correction = self.update(rows[axis], self.level[axis] * sigma**2, residuals[axis], correction)
        return correction

    def take_field(self, rate, now, sample, correction):
        p = self.p
        then = self.x.copy()
        then[2] -= euler_rates(self.x, rate + self.x[3:6])[2] * (now - sample[1])
        rows = jacobian(lambda y: field(y, self.declination), then)
        residual = sample[0] / np.linalg.norm(sample[0]) - field(then, self.declination)
        self.misfit[3] += 1
        jumped = False
        for axis, (row, r) in enumerate(zip(rows, residual, strict=True)):
            spread = row @ self.covariance @ row + p["field_sigma"] ** 2
            self.misfit[axis] += (r - row @ correction) / np.sqrt(spread)
            square = self.misfit[axis] ** 2 / self.misfit[3]
            if square > p["field_limit"] ** 2:
                self.covariance[7:10, 7:10] += square * spread * np.eye(3)
                jumped = True
            correction = self.update(row, p["field_sigma"] ** 2, r, correction)
        if jumped:
            self.misfit[:] = 0.0
        return correction

    def sigmas(self):
        p = self.p
        chart = self.chart_sigma
        if chart is None:
            chart = p["declination_sigma"] * np.cos(np.radians(60.0)) / np.cos(self.x[6])
        unseen = np.array([p["level_sigma"], p["level_sigma"], np.hypot(p["mounting_sigma"], chart)])
        return np.sqrt(np.diag(self.covariance)[:3] + unseen**2)
