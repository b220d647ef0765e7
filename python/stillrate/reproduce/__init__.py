"""Published figures, computed again: each table says what was reproduced and what was not."""
"""Published results, regenerated on simulated records and judged."""
"""Published studies run again: one module a study, each with a function ``reproduce``."""
"""Published tables beside ours; one function a paper section."""
