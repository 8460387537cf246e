"""The scene in plain numpy: types, boxes, cameras, features, voxels, grids. No I/O."""
