"""The robust method: finds mirror planes by comparing the reflected cloud with the cloud itself.

A plane reflects every point to its mirror image. The surface point nearest to the mirror image is the partner of the
point. The point agrees with the plane if the mirror image lies on the partner's surface and has its normal direction.
Otherwise it counts against the plane, by the non-match penalty at the mirror image. The penalty is low where a surface
may have been missed: beyond a boundary, or in space hidden from the viewpoint of a scan from one side.

`Robust.find` in `method` runs these stages in order. Lengths are in units of the cloud's diagonal.

1. Surface. `surface` estimates the surface that the cloud samples: normals, point confidence and boundary.
   `visibility` decides whether the cloud is a scan from one side and from where it was taken. `voxel_grid` stores the
   nearest surface point of every voxel around the cloud, and the non-match penalty there. The surface of a flat cloud
   is its outline with normals in its `sheet`, and all planes are upright on the sheet.
2. Search. `hypotheses` proposes 6 000 to 7 000 planes. `search` scores them all by the voxel grid and keeps the best.
3. Registration. `registration` moves these planes until the reflected cloud lies on the cloud: like ICP, but robust by
   the L2E weights. `search` then drops `duplicates` and scores the remaining planes, the candidates.
4. Refinement. `quadrics` fits a smooth patch around every point. `refinement` minimises the L2E criterion of the
   heights above these patches for the best candidates. `covariance` computes the standard errors.
5. Verification, in the subpackage `verification`. `scoring` computes the score and the exactness of every refined
   candidate on all points. Together they give the ranking score. `contradiction` measures which part of the cloud has
   its mirror image far from any surface, and whether a missing part explains that. `evidence` orders the candidates
   and decides which of them the cloud confirms. `classification` compares the scores with a threshold, decides which
   candidates are mirror planes, and what symmetry they make up: none, one plane, several planes, an axis, or a sphere.
   `layers` adds the error of sampling layers to the standard errors, and doubts planes that they leave uncertain.
   `notes` writes down what was assumed.
"""
