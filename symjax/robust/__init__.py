"""The robust method: L2E with correspondences that follow the plane, verified on the cloud."""
