"""symjax/l2e/pairs."""
