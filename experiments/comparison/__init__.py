"""All methods on the same corrupted clouds: tasks, rows, tables and curves of `experiments.studies.paper.arena` and its figures."""
