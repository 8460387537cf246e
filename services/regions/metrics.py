"""What regions counts for Prometheus."""

from __future__ import annotations

from prometheus_client import Counter, Histogram

FRAMES = Counter("ovip_regions_frames_total", "Frames added to the floor evidence")
SKIPPED = Counter("ovip_regions_skipped_batches_total", "Batches that could not be read")
PARTITIONS = Counter("ovip_regions_partitions_total", "Partitions written")
FALLBACKS = Counter("ovip_regions_fallbacks_total", "Floors grouped without the VLM")
PARTITION_SECONDS = Histogram(
    "ovip_regions_partition_seconds",
    "Time of one partition, the VLM included",
    buckets=(0.03, 0.1, 0.3, 1, 3, 10, 30, 60),
)
