"""JSBSim's Cessna 172P in SI units: its flight from a trimmed start, one step at a time.

JSBSim (https://jsbsim.sourceforge.net, LGPL) integrates the motion of a rigid body over the WGS-84 ellipsoid, with its
rotation and with gravity to the second zonal harmonic, J2. The aircraft (aerodynamic tables, engine, propeller,
weights; GPL) is the file c172p.xml that the package jsbsim holds: one pilot, 90 kg of fuel, 852 kg together.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from navfmu.constants import FOOT

MODEL = "c172p"
AXES = ("north", "east", "down")
CONTROLS = ("aileron", "elevator", "throttle", "rudder")
SECOND_ORDER = {
    "simulation/integrator/rate/rotational": 3.0,
    "simulation/integrator/position/rotational": 3.0,
    "simulation/integrator/rate/translational": 3.0,
    "simulation/integrator/position/translational": 3.0,
}
"""Adams-Bashforth of two steps for all; JSBSim's own choice for the rotation is Euler's method."""


class Cessna:
    """One flight. Controls are -1 to 1 (throttle 0 to 1), with the signs of ``models.motion.autopilot``."""

    def __init__(self, position, heading, airspeed, wind_n, period) -> None:
        """Trimmed in level flight, nose into the relative wind, engine running.

        ``position`` is latitude (rad), longitude (rad) and height above the ellipsoid (m); ``heading`` in rad,
        ``airspeed`` true in m/s, ``wind_n`` the velocity of the air over ground in n, m/s; ``period`` of a step in s.
        """
        self.fdm = fdm = _model()
        fdm.set_dt(float(period))
        latitude, longitude, altitude = position
        self._set(
            {
                "ic/terrain-elevation-ft": -1000.0,
                "ic/lat-geod-rad": latitude,
                "ic/long-gc-rad": longitude,
                "ic/h-sl-ft": altitude / FOOT,
                "ic/psi-true-rad": heading,
                "ic/vt-fps": airspeed / FOOT,
                "ic/gamma-rad": 0.0,
            }
        )
        fdm["ic/h-sl-ft"] += altitude / FOOT - fdm["ic/geod-alt-ft"]  # JSBSim's sea level is 1 cm off its ellipsoid
        fdm.run_ic()
        fdm.get_propulsion().init_running(-1)
        self._enrich()
        fdm["simulation/do_simple_trim"] = 1
        self.trim = {control: fdm[f"fcs/{control}-cmd-norm"] for control in CONTROLS}
        self._begin_in(np.asarray(wind_n, float))
        self._set(SECOND_ORDER)
        self.longitude = float(longitude)
        self.heading = float(heading)

    def _begin_in(self, wind_n) -> None:
        """Begin anew with the trimmed velocity relative to the air, which moves; JSBSim trims in a wind with slip."""
        fdm = self.fdm
        angles = {f"ic/{name}-rad": fdm[f"attitude/{name}-rad"] for name in ("phi", "theta")}
        angles["ic/psi-true-rad"] = fdm["attitude/psi-rad"]
        over_ground = {
            f"ic/v{axis[0]}-fps": fdm[f"velocities/v-{axis}-fps"] + wind / FOOT
            for axis, wind in zip(AXES, wind_n, strict=True)
        }
        self._set(
            {
                "ic/vw-mag-fps": np.hypot(wind_n[0], wind_n[1]) / FOOT,
                "ic/vw-dir-deg": np.degrees(np.arctan2(wind_n[1], wind_n[0])),  # where it goes to
                **angles,
                **over_ground,
                **angles,
            }
        )
        fdm.run_ic()
        self._blow(wind_n)

    def _set(self, values) -> None:
        for name, value in values.items():
            self.fdm[name] = float(value)

    def _blow(self, wind_n) -> None:
        for axis, wind in zip(AXES, wind_n, strict=True):
            self.fdm[f"atmosphere/wind-{axis}-fps"] = float(wind) / FOOT

    def _enrich(self) -> None:
        """Keep the mixture as rich as at sea level."""
        self.fdm["fcs/mixture-cmd-norm"] = min(1.0, self.fdm["atmosphere/delta"])

    def step(self, wind_n, **controls) -> None:
        """One period on, with the air moving at ``wind_n`` (m/s, n) and these controls."""
        self._blow(wind_n)
        for control, value in controls.items():
            self.fdm[f"fcs/{control}-cmd-norm"] = float(value)
        self._enrich()
        self.fdm.run()
        self.longitude = _continued(self.longitude, self.fdm["position/long-gc-rad"])
        self.heading = _continued(self.heading, self.fdm["attitude/psi-rad"])

    def _vector(self, names, factor=1.0):
        return factor * np.array([self.fdm[name] for name in names])

    @property
    def latitude(self):
        """Geodetic, rad."""
        return self.fdm["position/lat-geod-rad"]

    @property
    def altitude(self):
        """Of the centre of gravity above the ellipsoid, m."""
        return FOOT * self.fdm["position/geod-alt-ft"]

    @property
    def velocity_n(self):
        """Over ground, in n, m/s."""
        return self._vector([f"velocities/v-{axis}-fps" for axis in AXES], FOOT)

    @property
    def roll(self):
        """Rad."""
        return self.fdm["attitude/phi-rad"]

    @property
    def pitch(self):
        """Rad."""
        return self.fdm["attitude/theta-rad"]

    @property
    def specific_force(self):
        """All forces but gravity over the mass, at the centre of gravity, in b, m/s2."""
        force = self._vector([f"forces/fb{axis}-total-lbs" for axis in "xyz"])
        return FOOT * force / self.fdm["inertia/mass-slugs"]

    @property
    def rate(self):
        """Of b with respect to inertial space, in b, rad/s."""
        return self._vector([f"velocities/{axis}i-rad_sec" for axis in "pqr"])

    @property
    def relative_rate(self):
        """Of b with respect to e, in b, rad/s: what gyros show in a turn, without the earth's rate."""
        return self._vector([f"velocities/{axis}-rad_sec" for axis in "pqr"])

    @property
    def air_velocity_n(self):
        """Of the air over ground, in n, m/s."""
        return self._vector([f"atmosphere/total-wind-{axis}-fps" for axis in AXES], FOOT)

    @property
    def airspeed(self):
        """True, m/s."""
        return FOOT * self.fdm["velocities/vt-fps"]

    @property
    def angle_of_attack(self):
        """Rad, positive from below."""
        return self.fdm["aero/alpha-rad"]

    @property
    def sideslip(self):
        """Rad, positive from the right."""
        return self.fdm["aero/beta-rad"]


def _model():
    """JSBSim with the aircraft loaded; only warnings are printed."""
    import jsbsim

    before = jsbsim.get_logger()
    jsbsim.set_logger(jsbsim.DefaultLogger(jsbsim.LogLevel.WARN))
    try:
        fdm = jsbsim.FGFDMExec(str(Path(jsbsim.__file__).parent))
        fdm.set_debug_level(0)
        fdm.load_model(MODEL)
    finally:
        jsbsim.set_logger(before)
    return fdm


def _continued(before, angle):
    """The angle's value nearest to what it was before."""
    return before + (angle - before + np.pi) % (2.0 * np.pi) - np.pi
