"""Recorded motions under the platform and the camera gimbal, where the recordings are at hand."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from stillrate import platform as pf
from stillrate.platform.shipped import SHIPPED
from stillrate.platform.study import GIMBAL, PLATFORM, Design, setup_of, show

FOLDER = next(
    (p / "shared" / "data" / "recordings" for p in Path(__file__).parents if (p / "shared" / "data").is_dir()), None
)
pytestmark = pytest.mark.skipif(FOLDER is None, reason="the recordings are not part of the project")


def moved(design: Design, recording: str, axis: str, duration_s: float) -> pf.Run:
    """Run a design with a recorded rate under it."""
    assert FOLDER is not None
    setup = setup_of(design)
    with np.load(FOLDER / f"{recording}.npz") as archive:
        rate, t = archive[axis], archive["t_s"]
    motion = pf.Recorded(
        rate_dps=rate, sample_rate_hz=1.0 / float(np.median(np.diff(t))), range_deg=0.9 * setup.range_deg
    )
    return show(design, motion, setup=setup, duration_s=duration_s)


def shipped(family: str, plant: str) -> Design:
    """Return the design with the largest budget, at the plant's usual rate."""
    rate = 50.0 if plant == PLATFORM else 200.0
    own = [d for d in SHIPPED if d.family == family and d.plant == plant and d.sample_rate_hz == rate]
    return max(own, key=lambda design: design.budget_percent)


def test_a_vessel_rolls_under_the_platform_and_the_bank_leaves_less() -> None:
    raw, bank = (
        moved(shipped(name, PLATFORM), "vessel_sim_smsfusion", "gx_dps", 60.0) for name in ("none", "ms-imm-ikf+pt1")
    )
    assert raw.lost_at is None and bank.lost_at is None
    assert np.ptp(raw.base_deg) > 10.0, "the vessel hardly rolls"
    # Slow and smooth: much of what is left is the gyro's drift, which no filter takes away.
    assert bank.residual_deg[0] < raw.residual_deg[0] and bank.residual_deg[1] < raw.residual_deg[1]
    assert raw.residual_deg[1] < 0.05 * np.ptp(raw.base_deg)


def test_a_quadcopter_shakes_the_gimbal_and_the_camera_stays_level() -> None:
    for design in (d for d in SHIPPED if d.plant == GIMBAL):
        found = moved(design, "bbl_btfl_001", "gx_dps", 20.0)
        assert found.lost_at is None, design.family
        assert np.ptp(found.base_deg) > 5.0, "the quadcopter hardly moves"
        assert found.residual_deg[0] < 0.1 * float(np.std(found.base_deg)), design.family
