"""The store: a Redis dialect behind idempotent scripts, and blobs for bulk bytes (DESIGN 3)."""

from ovip.store.store import Append, Committed, Document, Entry, Ingested, Lease, Store

__all__ = ["Append", "Committed", "Document", "Entry", "Ingested", "Lease", "Store"]
