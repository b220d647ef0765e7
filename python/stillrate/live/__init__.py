"""Samples as they come: a line in, the clean line out, from stdin, UDP or a serial port.

`Loop` ties the parts together: a source (`source`), how its lines are laid out (`lines`, `clock`), the filter, a
sink (`sink`); `statistics` counts and times, `view` and `viewer` show.
"""

from stillrate.live.batch import Batch, Source
from stillrate.live.lines import LineFormat
from stillrate.live.loop import Loop, Tap, stop_on_signals
from stillrate.live.sink import Sink, open_sink
from stillrate.live.source import open_source
from stillrate.live.statistics import Statistics

__all__ = [
    "Batch",
    "LineFormat",
    "Loop",
    "Sink",
    "Source",
    "Statistics",
    "Tap",
    "open_sink",
    "open_source",
    "stop_on_signals",
]
