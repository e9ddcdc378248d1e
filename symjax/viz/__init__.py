"""Pictures of a detection, or of any object with points, a plane and pairs: an interactive page and a PNG image."""
