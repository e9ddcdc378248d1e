"""Point clouds and meshes in files: PLY, OBJ, OFF, STL, GLB, XYZ, TXT, CSV, NPY and PCD."""
