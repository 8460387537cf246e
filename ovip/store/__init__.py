"""The store: a Redis dialect behind idempotent scripts, and blobs for bulk bytes (DESIGN 3)."""

from ovip.store.store import Store
from ovip.store.values import Append, Appended, Committed, Document, Entry, Ingested, Lease

__all__ = ["Append", "Appended", "Committed", "Document", "Entry", "Ingested", "Lease", "Store"]
