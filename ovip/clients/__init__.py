"""Typed clients of every service, for services and the SDK; protobuf and gRPC stay inside.

All raise the tree of `ovip.errors`. Reads are tried again for a while when a service is away.
"""

from ovip.clients.connection import MAX_MESSAGE_BYTES, connect, error_of
from ovip.clients.mapper import MapperClient
from ovip.clients.perception import PerceptionClient
from ovip.clients.regions import RegionsClient
from ovip.clients.retrieval import RetrievalClient
from ovip.clients.vlm_gateway import VlmClient

__all__ = [
    "MAX_MESSAGE_BYTES",
    "MapperClient",
    "PerceptionClient",
    "RegionsClient",
    "RetrievalClient",
    "VlmClient",
    "connect",
    "error_of",
]
