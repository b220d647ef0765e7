"""Published results, regenerated on simulated records and judged."""
