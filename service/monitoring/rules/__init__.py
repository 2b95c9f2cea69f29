"""The findings that are reported to people, as they are declared: alert rule, limits, names and texts of each, and the limits
that a person sets for a machine. It imports `wording` and `alerts`; assessments take their limits and severities from it, and
`advice`, `delivery`, the API and the page their words.
"""
