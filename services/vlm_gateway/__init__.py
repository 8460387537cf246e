"""The VLM gateway: the only way out to a vision-language model (SPEC section 5)."""
