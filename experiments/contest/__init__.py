"""All methods on the same corrupted clouds: tasks, rows, tables and curves of `experiments.arena` and its figures."""
