"""Point clouds and meshes in files: PLY, OBJ, OFF, STL, XYZ, TXT, CSV, NPY and PCD."""
