"""symjax/l2e."""
