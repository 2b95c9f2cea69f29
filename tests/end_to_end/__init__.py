"""The whole service as separate processes."""
