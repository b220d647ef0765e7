"""Designs that come with the library: the 30 kg platform, tuned with one effort for every filter (see `tune`).

The figures that belong to them are measured anew by ``stillrate platform`` on seeds that their tuner did not see.
"""

from __future__ import annotations

from stillrate.platform.study import Design

SHIPPED: tuple[Design, ...] = ()
"""By budget and filter."""
