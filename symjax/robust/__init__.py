"""The robust method: the mirror plane of a cloud with outliers, holes and noise."""
