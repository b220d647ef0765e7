"""``stillrate calibrate gimbal``: every coefficient of a gimballed head from commands and accelerometers."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from cyclopts import Parameter

from stillrate.cli.options import Force, latitude_rad, refuse_taken

if TYPE_CHECKING:
    from stillrate.gimbal import Calibration


def command(
    commands: Annotated[Path, Parameter(name="IN")],
    accelerometers: Annotated[Path | None, Parameter(name="ACCELEROMETERS")] = None,
    /,
    *,
    output: Annotated[Path | None, Parameter(name=["--output", "-o"])] = None,
    report: Path | None = None,
    method: str = "relinearised",
    dt_s: float | None = None,
    sigma_m_s2: float | None = None,
    gravity_m_s2: float = 9.8,
    latitude_deg: float = 40.0,
    gauge: str = "accelerometer",
    torquer: bool = False,
    quadratic: bool = False,
    latency: bool = False,
    latitude: bool = False,
    angle_random_walk_deg_sqrt_h: float = 0.0,
    diagnose: bool = False,
    quiet: bool = False,
    force: Force = False,
) -> int:
    """Find gyro and accelerometer coefficients of a gimballed head from commands and accelerometer logs.

    Parameters
    ----------
    commands
        An npz with command_rad_s and specific_force_m_s2, or a table with t_s, wx_rad_s, wy_rad_s, wz_rad_s.
    accelerometers
        A table with t_s, ax_m_s2, ay_m_s2, az_m_s2, where the commands are a table.
    output
        Where the coefficients go (JSON).
    report
        Write a page with pictures as well (HTML).
    method
        relinearised, on-line, batch, two-stage, two-loop, first-order or literal.
    dt_s
        Time for which a command is held; needed if the log has no time.
    sigma_m_s2
        Noise of one accelerometer sample; found from the log otherwise.
    gravity_m_s2
        Gravity at the place, in m/s^2.
    latitude_deg
        Latitude of the place: it turns the Earth rate that the gyros see.
    angle_random_walk_deg_sqrt_h
        Angle random walk of the gyros in deg/sqrt(h); 0 leaves it out of the model.
    gauge
        accelerometer, gyro or none.
    torquer
        Estimate torquer scale errors too.
    quadratic
        Estimate quadratic accelerometer terms too.
    latency
        Estimate the latency of the accelerometers too.
    latitude
        Estimate the error of the latitude too.
    diagnose
        Calibrate once more with everything switched on and say what stands out.
    quiet
        No table.
    """
    from stillrate import gimbal
    from stillrate.errors import LogError
    from stillrate.io import gimbal as files

    refuse_taken([path for path in (output, report) if path], force=force)
    log = files.read(commands, accelerometers)
    step = dt_s if dt_s is not None else log.dt_s
    if step is None:
        raise LogError(f"{commands}: no time in it: give --dt-s")
    head = gimbal.Head(
        gravity_m_s2=gravity_m_s2,
        latitude_rad=latitude_rad(latitude_deg),
        gauge=gauge,  # type: ignore[arg-type]
        torquer=torquer,
        quadratic=quadratic,
        latency=latency,
        latitude=latitude,
        angle_random_walk_deg_sqrt_h=angle_random_walk_deg_sqrt_h,
    )
    found = gimbal.calibrate(
        log.command_rad_s, log.specific_force_m_s2, step, method, head=head, sigma_m_s2=sigma_m_s2, diagnose=diagnose
    )
    if output is not None:
        _write(output, found, method, force=force)
    if report is not None:
        from stillrate.report.gimbal import write_page

        write_page(report, found, commands.name, method, force=force)
    if not quiet:
        _show(found, method, [path for path in (output, report) if path])
    return 0


def _write(path: Path, found: Calibration, method: str, *, force: bool) -> None:
    from stillrate.io.safely import write_text

    def plain(value: float) -> float | None:
        return value if math.isfinite(value) else None

    rows = zip(found.names, found.coefficients, found.standard_deviation, strict=True)
    document: dict[str, Any] = {
        "format": "stillrate gimbal calibration",
        "version": 1,
        "method": method,
        "coefficients": {n: {"value": plain(float(x)), "standard_deviation": plain(float(s))} for n, x, s in rows},
        "flags": found.flags,
        "tests": found.tests,
        "sigma_m_s2": found.details["sigma_m_s2"],
    }
    write_text(path, json.dumps(document, indent=1) + "\n", force=force)


def _show(found: Calibration, method: str, written: list[Path]) -> None:
    from rich.console import Console

    from stillrate.report.gimbal import unit
    from stillrate.tables import plain_table

    console = Console(stderr=True)
    heads = ("coefficient", "value", "1 sigma", "unit")
    table = plain_table(f"gimbal calibration, {method}", heads, words=("coefficient", "unit"))
    for name, value, deviation in zip(found.names, found.coefficients, found.standard_deviation, strict=True):
        label, factor = unit(name)
        spread = f"{deviation * factor:.2g}" if deviation else "held"
        table.add_row(name, f"{value * factor:.6g}", spread, label)
    console.print(table)
    for name, text in found.flags.items():
        console.print(f"  {name}: {text}", highlight=False, markup=False)
    if written:
        console.print("wrote " + " and ".join(map(str, written)), highlight=False, markup=False, soft_wrap=True)
