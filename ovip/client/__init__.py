"""The SDK that a robot or a notebook imports: `from ovip.client import AsyncClient, Client`."""

from ovip.client.addresses import Addresses
from ovip.client.asynchronous import AsyncClient
from ovip.client.streaming import Hello, OutgoingDetection, OutgoingFrame, StreamReport
from ovip.client.synchronous import Client

__all__ = [
    "Addresses",
    "AsyncClient",
    "Client",
    "Hello",
    "OutgoingDetection",
    "OutgoingFrame",
    "StreamReport",
]
