"""Mapper: turns detections into objects that stay themselves (SPEC 2)."""
