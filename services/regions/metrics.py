"""What regions counts for Prometheus."""

from __future__ import annotations

from prometheus_client import Counter, Histogram

_SECONDS = (0.003, 0.01, 0.03, 0.1, 0.3, 1, 3, 10, 30, 60)

FRAMES = Counter("ovip_regions_frames_total", "Frames added to the floor evidence")
SKIPPED = Counter("ovip_regions_skipped_batches_total", "Batches that could not be read")
PARTITIONS = Counter("ovip_regions_partitions_total", "Partitions written")
UNCHANGED = Counter(
    "ovip_regions_unchanged_total", "Partitions made that changed nothing and were not written"
)
STALE_FLOORS = Counter("ovip_regions_stale_floors_total", "Floors cut anew because they had changed enough")
KEPT_FLOORS = Counter("ovip_regions_kept_floors_total", "Floors whose regions were kept as they were")
EVENTS = Counter("ovip_regions_events_total", "Region events written, by kind", ["kind"])
FALLBACKS = Counter("ovip_regions_fallbacks_total", "Floors grouped without the VLM")
LOST = Counter("ovip_regions_lost_total", "Kept evidence or partitions that could not be read", ["what"])
PARTITION_SECONDS = Histogram(
    "ovip_regions_partition_seconds", "Time of one partition, the VLM included", buckets=_SECONDS
)
STEP_SECONDS = Histogram(
    "ovip_regions_step_seconds",
    "Time of one step of a partition: map, survey, grouping, cut, save",
    ["step"],
    buckets=_SECONDS,
)
CHECKPOINT_BYTES = Counter(
    "ovip_regions_checkpoint_bytes_total", "Bytes of floor evidence written at checkpoints"
)
