"""The real models behind the seams: embedded (CPU, no torch), gateway (a VLM), full (GPU)."""
