"""symjax/method."""
