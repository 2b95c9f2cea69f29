"""Assessment of a filed identification against its baseline: changes, limits, and the text of findings. It imports `alerts`,
`workers`, `configuration`, `replication` and `resilience`; a finding that reaches a limit becomes an alert.
"""
