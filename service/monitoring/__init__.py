"""From a filed identification to its consequences: what it is compared with, the queue of assessments, the diagnosis that is
stored and the alerts that follow, with bands for trends. It imports its `assessment` and `rules`, `alerts`, `workers`,
`configuration`, `replication` and `resilience`; a finding that reaches a limit becomes an alert.
"""
