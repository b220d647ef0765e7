"""``stillrate calibrate reference-bias``: gyro bias from a log with reference attitudes."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from cyclopts import Parameter

from stillrate.cli.options import Force, ReadOptions, latitude_rad, refuse_taken
from stillrate.cli.problems import UsageError

if TYPE_CHECKING:
    import numpy as np
    import numpy.typing as npt
    from rich.table import Table

    from stillrate.bias import ReferenceBias
    from stillrate.io import Log

_NO_READING = ReadOptions()
# Standard deviations of chi-square above its mean: chance does it once in thousands of records.
_SURPRISING = 5.0


def command(
    source: Annotated[Path, Parameter(name="IN")],
    /,
    *,
    attitude: str = "qw,qx,qy,qz",
    latitude_deg: float = 0.0,
    longitude_deg: float = 0.0,
    mounting: bool = False,
    lag: bool = False,
    scale: bool = False,
    every_s: float | None = None,
    method: str = "exact",
    angle_random_walk: float = 0.3,
    reference_sigma_deg: float = 0.0,
    ignore_earth: bool = False,
    instantaneous: bool = False,
    output: Annotated[Path | None, Parameter(name=["--output", "-o"])] = None,
    force: Force = False,
    reading: ReadOptions = _NO_READING,
) -> int:
    """Find the bias of a gyro from reference attitudes (rate table, motion capture, GNSS/INS, camera).

    The log holds three rates and, in rows where there is a fix, the attitude body to north-east-down as a quaternion.

    Parameters
    ----------
    source
        The log: CSV, TSV, Parquet, npz, ...
    attitude
        The four quaternion columns, scalar first, separated by commas; empty or NaN where there is no fix.
    latitude_deg
        Latitude where the record was taken, north positive.
    longitude_deg
        Longitude where the record was taken, east positive.
    mounting
        Also estimate the rotation between reference and sensor.
    lag
        Also estimate how far the gyro's time lies behind the reference's.
    scale
        Also estimate scale factors.
    every_s
        Least time between the fixes used; default: all of them.
    method
        exact, or one of the classical shortcuts: small-angle, small-angle-jacobian, mean-rate.
    angle_random_walk
        Angle random walk of the gyro in deg/sqrt(h).
    reference_sigma_deg
        White error of each fix in deg an axis.
    ignore_earth
        The reference frame does not turn with the Earth, or its heading is unknown.
    instantaneous
        Rates are samples at an instant rather than means over the sample.
    output
        Write the result as JSON.
    """
    import numpy as np
    from rich.console import Console

    from stillrate.bias import reference_bias
    from stillrate.errors import LogError

    latitude = latitude_rad(latitude_deg)
    if every_s is not None and not every_s > 0:
        raise UsageError(f"--every-s {every_s:g} (must be > 0)")
    if not angle_random_walk > 0:
        raise UsageError(f"--angle-random-walk {angle_random_walk:g} (must be > 0 deg/sqrt(h))")
    if not reference_sigma_deg >= 0:
        raise UsageError(f"--reference-sigma-deg {reference_sigma_deg:g} (must be >= 0)")
    if output is not None:
        refuse_taken([output], force=force)
    log = reading.read(source)
    if log.rate_dps.shape[1] != 3:
        raise LogError(f"{source}: {log.rate_dps.shape[1]} rate columns (three are needed: name them with --columns)")
    steps = np.diff(log.t_s)
    index, quaternions = _fixes(log, source, attitude, every_s)
    found = reference_bias(
        np.radians(log.rate_dps[:-1]),
        steps,
        index,
        quaternions,
        latitude,
        math.radians(longitude_deg),
        mounting,
        estimate_lag=lag,
        estimate_scale=scale,
        method=method,
        angle_random_walk_rad_sqrt_s=math.radians(angle_random_walk) / 60.0,
        reference_sigma_rad=math.radians(reference_sigma_deg),
        earth_rate=not ignore_earth,
        instantaneous=instantaneous,
    )
    if output is not None:
        from stillrate.io.safely import write_text

        write_text(output, json.dumps(_record(found), indent=1) + "\n", force=force)
    console = Console()
    console.print(_table(found))
    if method == "exact" and not found.observable:
        names = ", ".join(found.unobservable) or "some combinations"
        console.print(f"not observable: the motion does not separate {names}; there the prior stands")
    if method == "exact" and (doubt := _misfit(found)):
        console.print(doubt)
    if method == "exact" and not found.converged:
        raise LogError(f"{source}: the iteration did not settle: fixes closer together, or a smaller bias, are needed")
    return 0


def _fixes(
    log: Log, source: Path, attitude: str, every_s: float | None
) -> tuple[npt.NDArray[np.int64], npt.NDArray[np.float64]]:
    """Return the rows with a usable quaternion, and the quaternions."""
    import numpy as np

    from stillrate.errors import LogError

    names = [name.strip() for name in attitude.split(",")]
    if len(names) != 4:
        raise UsageError(f"--attitude {attitude}: four column names are needed (scalar first)")
    if missing := [name for name in names if name not in log.columns]:
        raise LogError(f"{source}: no column {missing[0]} (the attitude; columns: {', '.join(log.columns) or 'none'})")
    columns = np.stack([np.asarray(log.columns[name], dtype=np.float64) for name in names], axis=1)
    index = np.flatnonzero(np.isfinite(columns).all(axis=1))
    if every_s is not None and index.size:
        slot = np.floor((log.t_s[index] - log.t_s[index[0]]) / every_s)
        index = index[np.unique(slot, return_index=True)[1]]
    if index.size < 2:
        raise LogError(
            f"{source}: {index.size} {'row' if index.size == 1 else 'rows'} with a finite attitude (at least 2 are needed)"
        )
    return index, columns[index]


def _misfit(found: ReferenceBias) -> str:
    """Return a remark if the residuals are larger than chance allows, or nothing."""
    freedom = found.degrees_of_freedom
    if found.chi_square <= freedom + _SURPRISING * math.sqrt(2.0 * freedom):
        return ""
    return (
        f"doubtful: the residuals are {math.sqrt(found.chi_square / max(freedom, 1)):.3g} times what the noise given explains, and the"
        " standard deviations are too small; check the frame (north-east-down or --ignore-earth), --latitude-deg, the axes"
        " (--mounting), the order of the quaternion, --lag, --angle-random-walk and --reference-sigma-deg"
    )


def _record(found: ReferenceBias) -> dict[str, Any]:
    from dataclasses import asdict

    import numpy as np

    fields = {name: value for name, value in asdict(found).items() if name != "history"}
    return {name: value.tolist() if isinstance(value, np.ndarray) else value for name, value in fields.items()}


def _table(found: ReferenceBias) -> Table:
    import numpy as np

    from stillrate.tables import plain_table

    heads = ("unknown", "estimate", "standard deviation", "after/before")
    table = plain_table("Gyro bias from the reference attitude", heads, words=("unknown",))
    sigma = np.sqrt(np.diag(found.covariance))
    to_deg_h, to_deg = math.degrees(1.0) * 3600.0, math.degrees(1.0)
    values = {f"bias_{a}": (found.bias_rad_s[k], to_deg_h, "deg/h") for k, a in enumerate("xyz")}
    values |= {f"mounting_{a}": (found.mounting_rad[k], to_deg, "deg") for k, a in enumerate("xyz")}
    values |= {f"scale_{a}": (found.scale[k], 1e6, "ppm") for k, a in enumerate("xyz")}
    values["lag"] = (found.lag_s, 1e3, "ms")
    for k, name in enumerate(found.names):
        value, factor, unit = values[name]
        row = (f"{value * factor:.6g} {unit}", f"{sigma[k] * factor:.3g}", f"{found.posterior_over_prior[k]:.3g}")
        table.add_row(name, *row)
    return table
