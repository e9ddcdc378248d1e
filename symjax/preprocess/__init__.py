"""symjax/preprocess."""
