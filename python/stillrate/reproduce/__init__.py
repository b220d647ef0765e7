"""Published studies run again: one module a study, each with a function ``reproduce``."""
