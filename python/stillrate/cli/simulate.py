"""``stillrate simulate``: a gyro log of which the truth is known."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal

from cyclopts import Parameter

from stillrate.cli.options import Force, refuse_taken
from stillrate.cli.problems import UsageError


def command(
    bed: Literal["static", "waves", "rough-waves", "steps", "chirp"] = "waves",
    /,
    *,
    output: Annotated[Path, Parameter(name=["--output", "-o"])],
    rate: float = 50.0,
    seed: int = 1,
    channels: int = 1,
    duration: float | None = None,
    density: float | None = None,
    bias_instability: float | None = None,
    rate_random_walk: float | None = None,
    lsb: float = 0.0,
    saturation: float = float("inf"),
    missing: float = 0.0,
    force: Force = False,
) -> int:
    """Write a simulated gyro log: what the gyro reads and, beside it, the truth.

    Parameters
    ----------
    bed
        The motion.
    output
        Where the log goes; the name's ending says in which format.
    rate
        Sample rate in Hz.
    seed
        Seed; each further channel takes the next one.
    channels
        Number of axes, 1 to 3.
    duration
        Length in s; default that of the bed.
    density
        Two-sided density of the white noise in deg/s/sqrt(Hz); default 0.0151.
    bias_instability
        Flicker noise in deg/s, instead of the usual Gauss-Markov bias of 0.01 deg/s over 20 s.
    rate_random_walk
        Rate random walk in deg/s/sqrt(s); default 0.001.
    lsb
        Quantisation step in deg/s.
    saturation
        Full scale in deg/s.
    missing
        Probability that a sample is missing.
    """
    import dataclasses

    import numpy as np

    from stillrate import io, simulate

    if output.suffix.lower() not in io.writable():
        raise UsageError(f"{output}: cannot write {output.suffix or 'it'} (endings: {', '.join(io.writable())})")
    if not 1 <= channels <= 3:
        raise UsageError(f"--channels {channels} (must be 1, 2 or 3)")
    refuse_taken([output], force=force)
    gyro = simulate.GyroModel(lsb_dps=lsb, saturation_dps=saturation, missing_probability=missing)
    if density is not None:
        gyro = dataclasses.replace(gyro, density_dps_sqrt_hz=density)
    if bias_instability is not None:
        gyro = dataclasses.replace(gyro, bias_instability_dps=bias_instability, bias_sigma_dps=0.0)
    if rate_random_walk is not None:
        gyro = dataclasses.replace(gyro, rate_random_walk_dps_sqrt_s=rate_random_walk)
    beds = [simulate.bed(bed, rate, seed + axis, duration_s=duration, noise=gyro) for axis in range(channels)]
    if not len(beds[0].t_s):
        raise UsageError(f"--rate {rate:g} (not one sample in that time)")
    log = io.Log(
        t_s=beds[0].t_s,
        rate_dps=np.column_stack([run.measured_dps for run in beds]),
        channels=tuple(f"g{axis}_dps" for axis in "xyz"[:channels]),
        sample_rate_hz=rate,
        columns={f"g{axis}_true_dps": run.truth_dps for axis, run in zip("xyz", beds, strict=False)},
        meta={"simulated": {"bed": bed, "seed": seed, "sample_rate_hz": rate, "gyro": str(gyro)}},
    )
    io.write(output, log, force=force)
    return 0
