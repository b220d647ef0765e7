"""The plant of one axis, from its equations' parameters or from a designer's figures."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from stillrate import _native


@dataclass(frozen=True, kw_only=True)
class PlatformDesign:
    """What a designer knows of a spindle-driven platform; `Plant.from_design` turns it into equations.

    The defaults are the paper's 30 kg platform; lead, inertia, coupling, play and electrics are assumed.

    Parameters
    ----------
    mass_kg, diameter_m : float
        The platform, kg and m: a disc and 20 % of inertia for what stands on it.
    arm_m, lead_m : float
        Arm of the spindle in m and its lead in m a turn: their ratio is the gear.
    motor_rpm : float
        Motor speed without load at full voltage, rpm.
    natural_frequency_hz : float
        As a pendulum, Hz; 0 is balanced.
    motor_inertia_kg_m2 : float
        Inertia of the motor, kg m^2.
    coupling_hz : float
        Frequency of the coupling, Hz.
    half_backlash_deg : float
        Half of the play, deg.
    voltage_max_v, current_max_a : float
        Supply voltage in V and current limit in A.

    Examples
    --------
    >>> fine = PlatformDesign(lead_m=0.01)
    >>> round(Plant.from_design(fine).gear_ratio / Plant.platform_30kg().gear_ratio, 9)
    2.0
    """

    mass_kg: float = 30.0
    diameter_m: float = 0.45
    arm_m: float = 0.2
    lead_m: float = 0.02
    motor_rpm: float = 720.0
    natural_frequency_hz: float = 1.0
    motor_inertia_kg_m2: float = 2e-4
    coupling_hz: float = 30.0
    half_backlash_deg: float = 0.05
    voltage_max_v: float = 24.0
    current_max_a: float = 3.0


@dataclass(frozen=True, kw_only=True)
class Plant:
    """One axis of a platform, SI and radians.

    Parameters
    ----------
    inertia_kg_m2 : float
        J: inertia of the platform, kg m^2.
    pendulum_n_m : float
        kg: pendulum stiffness at theta = 0, N m.
    bearing_viscous_n_m_s : float
        Bp: viscous friction of the platform bearing, N m s.
    bearing_dry_n_m : float
        Tp: dry friction of the platform bearing, N m.
    bearing_rate_rad_s : float
        wp: rate at which the dry friction of the bearing is nearly reached, rad/s.
    coupling_stiffness_n_m : float
        kc: stiffness of the coupling, N m/rad.
    coupling_damping_n_m_s : float
        cc: damping of the coupling, N m s.
    half_backlash_rad : float
        hb: half of the play, rad.
    contact_softness_rad : float
        ds: twist over which the coupling's damping comes in, rad.
    drive_inertia_kg_m2 : float
        Jr: inertia of the drive, seen at the platform, kg m^2.
    bristle_stiffness_n_m : float
        s0: bristle stiffness, N m/rad.
    bristle_damping_n_m_s : float
        s1: bristle damping, N m s.
    drive_viscous_n_m_s : float
        s2: viscous friction of the drive, N m s.
    coulomb_n_m : float
        Fc: Coulomb friction of the drive, N m.
    stiction_n_m : float
        Fs: stiction of the drive, N m.
    stribeck_rate_rad_s : float
        vs: Stribeck rate, rad/s.
    gear_ratio : float
        n: gear ratio.
    motor_constant_v_s : float
        Ke: motor constant, V s/rad.
    resistance_ohm : float
        R: winding resistance, ohm.
    current_time_s : float
        te: time constant of the current loop, s.
    voltage_max_v : float
        Vmax: supply voltage, V.
    current_max_a : float
        Imax: current limit, A.
    gyro_bandwidth_rad_s : float
        wg: bandwidth of the gyro, rad/s.
    hose_stiffness_n_m : float
        ks: stiffness of a hose or cable between base and platform, N m/rad.
    curves : str
        "algebraic" (default: the same bits everywhere, nearly twice the speed) or "transcendental" (tanh, exp, sin: the
        textbook form).

    Examples
    --------
    >>> plant = Plant.platform_30kg()
    >>> round(plant.inertia_kg_m2, 4)
    0.4556
    >>> plant == Plant.from_design(PlatformDesign())
    True
    >>> loose = plant.replace(half_backlash_rad=4.0 * plant.half_backlash_rad)
    >>> gimbal = Plant.camera_gimbal()
    >>> loose.half_backlash_rad > plant.half_backlash_rad > gimbal.half_backlash_rad
    True

    Parameters under the names that the equations give them:

    >>> symbols = dict(J=0.46, kg=18.0, Bp=0.5, Tp=0.5, wp=0.01, kc=16e3, cc=8.6, hb=9e-4, ds=1e-4, Jr=0.79, s0=4e3, s1=20.0)
    >>> symbols |= dict(s2=2.0, Fc=4.0, Fs=6.0, vs=0.02, n=63.0, Ke=0.32, R=1.0, te=2e-3, Vmax=24.0, Imax=3.0, wg=251.0, ks=0.0)
    >>> Plant.from_symbols(symbols, curves="transcendental").coulomb_n_m
    4.0
    """

    inertia_kg_m2: float
    pendulum_n_m: float
    bearing_viscous_n_m_s: float
    bearing_dry_n_m: float
    bearing_rate_rad_s: float
    coupling_stiffness_n_m: float
    coupling_damping_n_m_s: float
    half_backlash_rad: float
    contact_softness_rad: float
    drive_inertia_kg_m2: float
    bristle_stiffness_n_m: float
    bristle_damping_n_m_s: float
    drive_viscous_n_m_s: float
    coulomb_n_m: float
    stiction_n_m: float
    stribeck_rate_rad_s: float
    gear_ratio: float
    motor_constant_v_s: float
    resistance_ohm: float
    current_time_s: float
    voltage_max_v: float
    current_max_a: float
    gyro_bandwidth_rad_s: float
    hose_stiffness_n_m: float
    curves: str = "algebraic"

    @classmethod
    def platform_30kg(cls) -> Plant:
        """Return the paper's platform."""
        return cls._of(_native.servo_plant("platform-30kg"))

    @classmethod
    def camera_gimbal(cls) -> Plant:
        """Return a small camera gimbal: direct drive, no play."""
        return cls._of(_native.servo_plant("camera-gimbal"))

    @classmethod
    def from_design(cls, design: PlatformDesign) -> Plant:
        """Return the parameters that follow from a design.

        Raises
        ------
        ConfigError
            If a number of the design is out of range; the text names it.
        """
        return cls._of(_native.servo_plant("design", design))

    @classmethod
    def from_symbols(cls, symbols: dict[str, float], *, curves: str = "algebraic") -> Plant:
        """Return a plant from the symbols of the equations (J, kg, Bp, Tp, wp, kc, cc, hb, ds, Jr, ...)."""
        named: dict[str, Any] = {name: float(symbols[symbol]) for name, symbol, _ in _native.servo_plant_fields()}
        return cls(**named).replace(curves=curves)

    @classmethod
    def _of(cls, numbers: Sequence[float]) -> Plant:
        names = [name for name, _, _ in _native.servo_plant_fields()]
        named: dict[str, Any] = dict(zip(names, numbers, strict=True))
        return cls(**named)

    def replace(self, **changes: float | str) -> Plant:
        """Return a copy with some parameters changed."""
        return dataclasses.replace(self, **changes)  # type: ignore[arg-type]
