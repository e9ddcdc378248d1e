"""The golden file: answers that a change of the structure must not change."""
