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
    >>> round(Plant.platform_30kg().inertia_kg_m2, 4)
    0.4556
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
