"""Real logs and recordings. They are no part of the project: a folder `shared/data` beside the checkout, or above it, may hold them.

`formats/` are files as loggers wrote them, `recordings/` three axes each as npz: `t_s`, `gx_dps`, `gy_dps`, `gz_dps`, `meta_json`.
"""

from __future__ import annotations

from pathlib import Path

import pytest

DATA = next(
    (p / "shared/data" for p in Path(__file__).resolve().parents if (p / "shared/data").is_dir()), Path("absent")
)
FORMATS, RECORDINGS = DATA / "formats", DATA / "recordings"
needed = pytest.mark.skipif(not DATA.is_dir(), reason="real logs are no part of the project and not here")
