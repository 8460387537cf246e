"""The other services, reached by their clients."""
