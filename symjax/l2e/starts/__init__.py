"""symjax/l2e/starts."""
