"""What stands behind the seams: the VLM gateway, and the function table that needs none."""
