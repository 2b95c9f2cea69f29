"""Parameter histories in columns, downsampled, in the requested units. It imports `conventions`, `cache` and `monitoring`."""
