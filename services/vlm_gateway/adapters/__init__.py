"""The gateway's real seams: an OpenAI-compatible upstream and limits shared through the store."""
