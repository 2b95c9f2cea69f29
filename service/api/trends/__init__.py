"""Parameter histories in columns, downsampled and in the requested units. It imports `conventions`, `cache` and `monitoring`.
"""
