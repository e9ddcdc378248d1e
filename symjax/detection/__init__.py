"""`detect`: prepares a cloud, asks a method, and answers with a `Detection` in the units of the given points."""
