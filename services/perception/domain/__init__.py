"""E2G + FAV-Gate in plain numpy: the vocabulary gate, boxes of one frame, lifting to 3D."""
