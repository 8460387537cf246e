"""The paper: from depth and objects to regions, pure."""
