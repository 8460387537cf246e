"""The HTTP side of the api: it translates between requests and the service."""

from services.api.server.app import create_app

__all__ = ["create_app"]
