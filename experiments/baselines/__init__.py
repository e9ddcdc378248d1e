"""Other methods: each is a `symjax.Method` in a file of its own, faithful to its publication."""
