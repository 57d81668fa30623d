"""The constant-orientation workspace of the 5-RPUR and the vertex spaces of its limbs as solids.

vertex_space    where one limb lets O' be: Bohemian domes, their holes and what is between
workspace       the intersection over the limbs, for any working modes
true_surface    the same with every vertex on the exact surfaces
sheets          those surfaces, and points moved onto several of them
refinement      edges halved where they sag
folds           triangles that turned over, mended
"""
