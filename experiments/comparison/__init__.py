"""All methods on the same corrupted clouds: objects, tasks, rows, leaderboard, curves and what the paper prints."""
