"""Parameter histories in columns, downsampled, in the requested units. It imports `conventions`, `cache`, `security`,
`monitoring` and `export`; estimates come from the store and are kept in memory between requests.
"""
