"""A folder of logs: each cleaned, one table of what was found; a broken log is named and does not stop the rest.

Run it twice: the second run finds nothing left to do. For many logs on many cores there is ``stillrate fleet``; this shows
the same with nothing but the library. Usage: python fleet.py [FOLDER]
"""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path

import stillrate as sr
from stillrate.cleaning import clean, settings_for

KINDS = ("static", "waves", "steps", "rough-waves")


def pretend(folder: Path) -> None:
    """Write six logs, one of them broken."""
    folder.mkdir(parents=True, exist_ok=True)
    for number in range(5):
        run = sr.simulate.bed(KINDS[number % 4], 50.0, seed=100 + number)
        log = sr.Log(t_s=run.t_s, rate_dps=run.measured_dps, channels=("gx_dps",), sample_rate_hz=50.0)
        sr.write(folder / f"unit-{number}.csv", log, force=True)
    (folder / "unit-5.csv").write_text("t_s,gx_dps\nthis is, no log\n", encoding="utf-8")


def one(source: Path, target: Path) -> str:
    """Clean one log; return its line of the table."""
    log = sr.read(source)
    configs, _ = settings_for(log)
    done = clean(log, configs)
    sr.write(target, done.clean)
    density = next(iter(configs.values())).noise.density_dps_sqrt_hz
    removed = sr.metrics.rmse(done.clean.rate_dps[:, 0], log.rate_dps[:, 0])
    return f"{len(log):7d} samples, N = {density:.4f} deg/s/√Hz, taken away {removed:.4f} deg/s RMS"


def main(folder: Path) -> dict[str, list[str]]:
    """Clean every log that has no result yet; return the names by outcome."""
    logs, results = folder / "logs", folder / "clean"
    if not logs.exists():
        pretend(logs)
    results.mkdir(exist_ok=True)
    outcome: dict[str, list[str]] = {"done": [], "kept": [], "broken": []}
    for source in sorted(logs.glob("*.csv")):
        target = results / source.name
        if target.exists():
            outcome["kept"].append(source.name)
            continue
        try:
            print(f"{source.name}: {one(source, target)}")
            outcome["done"].append(source.name)
        except sr.LogError as error:
            print(f"{source.name}: left out: {error}")
            outcome["broken"].append(source.name)
    print(", ".join(f"{len(names)} {word}" for word, names in outcome.items()))
    return outcome


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else Path(tempfile.mkdtemp()))
