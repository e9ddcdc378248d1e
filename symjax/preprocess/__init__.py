"""From input points to a cloud: checked, without outliers and ground plane, thinned, and in the cloud frame."""
