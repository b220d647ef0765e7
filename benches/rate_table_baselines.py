"""The published table with its VMD baseline: variational modes, each thresholded by wavelets, beside QPSO-KF and BP-KF.

Run with `python benches/rate_table_baselines.py [--seeds 2] [--json FILE]`; needs vmdpy and PyWavelets.
"""

from __future__ import annotations

import argparse
import json
from pathlib import Path

import numpy as np
import pywt
import stillrate as sr
from stillrate import _native
from vmdpy import VMD

MODES, PENALTY, WAVELET, LEVELS = 5, 2000.0, "sym8", 6


def denoise(z: np.ndarray) -> np.ndarray:
    """Soft universal threshold on the wavelet coefficients of each of five variational modes."""
    modes, _, _ = VMD(z, PENALTY, 0.0, MODES, 0, 1, 1e-7)
    out = np.zeros(modes.shape[1])
    for mode in modes:
        level = min(LEVELS, pywt.dwt_max_level(mode.size, WAVELET))
        approximation, *details = pywt.wavedec(mode, WAVELET, level=level)
        sigma = np.median(np.abs(details[-1])) / 0.6745
        threshold = sigma * np.sqrt(2.0 * np.log(mode.size))
        kept = [pywt.threshold(detail, threshold, "soft") for detail in details]
        out += pywt.waverec([approximation, *kept], WAVELET)[: mode.size]
    return out[: z.size]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seeds", type=int, default=2)
    parser.add_argument("--json", type=Path)
    arguments = parser.parse_args()
    found: dict[str, list[float]] = {}
    for seed in range(1, arguments.seeds + 1):
        records = _native.rate_table_published(0, seed)
        table = _native.rate_table_table3(0, seed, 5)
        for method, mse, _ in table["rows"]:
            if "network" not in method:
                found.setdefault(method, []).extend(mse)
        found.setdefault("VMD + wavelet threshold", []).extend(
            sr.rate_table.compare(denoise(z[: z.size // 2 * 2]), truth[: z.size // 2 * 2]).mse for truth, z in records
        )
    for method, values in found.items():
        print(f"| {method} | {np.median(values):.2e} [{min(values):.1e}, {max(values):.1e}] |")
    for first, second in [("QPSO-KF", "VMD + wavelet threshold"), ("VMD + wavelet threshold", "BP-KF (stand-in)")]:
        below = sum(a < b for a, b in zip(found[first], found[second], strict=True))
        print(f"{first} below {second}: {below} of {len(found[first])}")
    if arguments.json:
        arguments.json.write_text(json.dumps(found, indent=1) + "\n")


if __name__ == "__main__":
    main()
