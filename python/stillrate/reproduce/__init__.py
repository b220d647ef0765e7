"""Published figures, computed again: each table says what was reproduced and what was not."""
