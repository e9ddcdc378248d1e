"""What all studies share: the description of a study, the command that runs it, its files, and the catalogue."""
