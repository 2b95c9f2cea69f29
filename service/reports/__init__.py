"""Reports of machines as PDF: read from the store, printed in a worker process, sent by mail. It imports `advice`,
`balancing`, `identification` and `monitoring` for what is told, `workers` to print and `delivery` to send.
"""
