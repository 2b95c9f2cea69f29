"""Parameter histories in columns, downsampled, in the requested units. It imports `conventions`, `cache`, `security` and
`monitoring`; estimates come from the store and are kept in memory between requests.
"""
