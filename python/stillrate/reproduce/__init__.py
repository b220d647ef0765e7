"""Published figures, computed again: one module a study; each row says what was reproduced, what was not, and why."""
