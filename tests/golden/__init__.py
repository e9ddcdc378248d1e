"""The golden file: results that refactoring must not change."""
