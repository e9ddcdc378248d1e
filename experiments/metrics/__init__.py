"""How answers are scored: every metric in a file of its own, with the definition that it was published with."""
