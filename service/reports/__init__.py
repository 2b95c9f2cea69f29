"""Reports of machines as PDF: read from the store, printed in a worker process, sent by mail. It imports `advice`, `alerts`,
`balancing`, `configuration`, `delivery`, `identification`, `monitoring`, `replication`, `resilience`,
`wording` and `workers`.
"""
