"""Studies of the robust method: its correctness, the effect of each stage, and its thresholds and standard errors."""
