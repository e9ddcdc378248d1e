"""What all studies share: how one is described, run and written down, and the list of all."""
