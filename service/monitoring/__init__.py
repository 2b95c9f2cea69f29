"""A filed identification against its baseline: changes, limits, and the words for what was found. It imports `alerts` and
`resilience`; what reaches a limit becomes an alert.
"""
