"""What the api computes itself: cursors, JSON shapes, point clouds and pictures. No I/O."""
