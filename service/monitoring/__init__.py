"""Assessment of a filed identification against its baseline: changes, limits, and the texts of findings. It imports `alerts`,
`wording`, `workers`, `configuration`, `replication` and `resilience`; a finding that reaches a limit becomes an alert.
"""
