"""Reports of machines as PDF: read from the store, drawn and printed in a worker process, and sent by mail or answered by the
API. It imports `advice`, `alerts`, `balancing`, `configuration`, `delivery`, `identification`, `monitoring`, `replication`,
`resilience`, `wording` and `workers`.
"""
