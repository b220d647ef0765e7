"""Run one axis of the platform, or its plant alone."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from stillrate import _native
from stillrate.platform.model import Controller, GyroErrors, Link, LoopFilter, Plant, Setup, links
from stillrate.platform.motion import Base

COLUMNS = ("theta", "u", "w", "y", "theta_hat", "alpha", "phi", "nu")


@dataclass(frozen=True, eq=False)
class Run:
    """What happened, one row a control tick.

    Attributes
    ----------
    t_s : ndarray (n,)
        Time of each tick.
    record : ndarray (n, 8)
        Platform angle, voltage, filtered rate, gyro sample, estimated angle, drive angle, base angle, drive rate; SI
        and radians, columns named in `columns`.
    lost_at, out_of_stroke_at : int or None
        Tick at which the platform was lost (beyond 10 rad or not finite; the run ends there), and first tick at which
        the drive stood beyond its range.
    residual_deg : (float, float)
        Root mean square and largest magnitude of the angle from 3 s on, degrees (0 for a shorter run).
    warnings : tuple of str
        An unreachable base rate, an angle beyond the range, an unstable loop, each with the number that shows it.

    Examples
    --------
    >>> from stillrate.platform import Tilt
    >>> tilted = run(Tilt(amplitude_deg=10.0), duration_s=8.0)
    >>> round(float(tilted.base_deg[-1]), 9), bool(abs(tilted.angle_deg[-1]) < 0.3)
    (10.0, True)
    >>> drive = np.degrees(tilted.column("alpha"))  # it has turned back what the base tilted
    >>> bool(abs(drive[-1] + 10.0) < 0.5)
    True
    """

    t_s: NDArray[np.float64]
    record: NDArray[np.float64]
    lost_at: int | None
    out_of_stroke_at: int | None
    residual_deg: tuple[float, float]
    warnings: tuple[str, ...]
    columns: tuple[str, ...] = COLUMNS

    def column(self, name: str) -> NDArray[np.float64]:
        """Return one column by name (SI, radians)."""
        found: NDArray[np.float64] = self.record[:, self.columns.index(name)]
        return found

    @property
    def angle_deg(self) -> NDArray[np.float64]:
        """Platform angle in degrees."""
        return np.degrees(self.column("theta"))

    @property
    def base_deg(self) -> NDArray[np.float64]:
        """Base angle in degrees."""
        return np.degrees(self.column("phi"))


def run(
    base: Base,
    *,
    setup: Setup | None = None,
    controller: Controller | None = None,
    filter: LoopFilter | Sequence[LoopFilter] | None = None,
    gyro: GyroErrors | None = None,
    seed: int = 0,
    start_deg: float = 0.0,
    reference_deg: float = 0.0,
    duration_s: float = 8.0,
) -> Run:
    """Simulate one axis in closed loop.

    Two axes are two independent runs: pitch and roll do not couple in this model.

    Parameters
    ----------
    base : Tilt, Sine, Constant or Recorded
        How the base moves.
    setup : Setup, optional
        Plant and timing; default the paper's 30 kg platform at 50 Hz.
    controller : Controller, optional
        Gains.
    filter : configuration, textbook filter or a sequence of them, optional
        What stands in the loop, first to last; default nothing.
    gyro : GyroErrors, optional
        Default: the setup's white noise and bias with `seed`.
    start_deg : float
        Angle at the start, known to the controller.
    reference_deg : float
        Angle to hold.
    duration_s : float
        Length of the run in s.

    Returns
    -------
    Run

    Raises
    ------
    ConfigError
        If a parameter is out of range; the text names it.

    Examples
    --------
    >>> from stillrate.platform import LoopPt1, Sine
    >>> swing = run(Sine(amplitude_deg=10.0, frequency_hz=1.0), filter=LoopPt1(cutoff_hz=5.3))
    >>> swing.record.shape
    (400, 8)
    """
    setup = Setup() if setup is None else setup
    controller = Controller() if controller is None else controller
    gyro = _gyro(setup, seed) if gyro is None else gyro
    chain = links(filter, setup.sample_rate_hz)
    return _run(base, chain, setup, controller, gyro, (start_deg, reference_deg, duration_s))


def run_links(
    base: Base,
    chain: list[Link],
    *,
    setup: Setup,
    controller: Controller,
    seed: int,
    duration_s: float,
    start_deg: float = 0.0,
) -> Run:
    """Run with the filter as a chain of methods and settings, and the setup's own gyro; `run` is the convenient form."""
    return _run(base, chain, setup, controller, _gyro(setup, seed), (start_deg, 0.0, duration_s))


def _gyro(setup: Setup, seed: int) -> GyroErrors:
    sigma = setup.noise.density_dps_sqrt_hz * float(np.sqrt(max(setup.sample_rate_hz, 0.0)))
    return GyroErrors(white_sigma_dps=sigma, bias_dps=setup.bias_dps, seed=seed)


def _run(
    base: Base,
    chain: list[Link],
    setup: Setup,
    controller: Controller,
    gyro: GyroErrors,
    times: tuple[float, float, float],
) -> Run:
    """Run; `times` are start and reference in degrees and duration in seconds."""
    found = _native.servo_run(setup, controller, chain, base, gyro, times)
    record: NDArray[np.float64] = found["record"]
    return Run(
        t_s=np.arange(len(record)) / setup.sample_rate_hz,
        record=record,
        lost_at=found["lost_at"],
        out_of_stroke_at=found["out_of_stroke_at"],
        residual_deg=tuple(found["residual_deg"]),
        warnings=tuple(found["warnings"]),
    )


def open_loop(
    voltage_v: ArrayLike,
    *,
    base: Base,
    plant: Plant | None = None,
    period_s: float = 0.02,
    dt_s: float = 1e-3,
    start: Sequence[float] = (0.0,) * 7,
) -> NDArray[np.float64]:
    """Drive the plant alone with given voltages, each held for a period.

    Parameters
    ----------
    voltage_v : array_like (n,)
        Voltages in V.
    base : Tilt, Sine, Constant or Recorded
        How the base moves.
    plant : Plant, optional
        Default the paper's 30 kg platform.
    period_s, dt_s : float
        How long a voltage is held, and the integration step, s.
    start : sequence of 7 float
        States at the start. A drive angle far from the platform's less the base's twists the coupling, which throws the
        drive to rates that the step was not checked for: what follows may not be finite.

    Returns
    -------
    ndarray (n + 1, 7)
        Platform angle and rate, drive angle and rate, current, bristle, gyro (SI, radians): at the start and after
        every period.

    Raises
    ------
    ConfigError
        If a parameter is out of range; the text names it.

    Examples
    --------
    >>> from stillrate.platform import Constant
    >>> states = open_loop([3.0] * 50, base=Constant())
    >>> states.shape
    (51, 7)
    >>> bool(states[-1, 2] > 0.0 and 0.0 < states[-1, 4] < 3.0)  # turning, and the back EMF takes from 3 V / 1 ohm
    True
    """
    states: NDArray[np.float64] = _native.servo_open_loop(
        Plant.platform_30kg() if plant is None else plant,
        base,
        np.ascontiguousarray(voltage_v, dtype=np.float64),
        [float(x) for x in start],
        (dt_s, max(round(period_s / dt_s), 1)),
    )
    return states
