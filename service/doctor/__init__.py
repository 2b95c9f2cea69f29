"""Examines a deployment from outside: settings, database, certificates, and endpoints open to strangers. It imports
`configuration`, `messaging`, `security`, `maintenance`, `delivery`, `wire` and `api`, whose operations it probes; `commands`
prints its results.
"""
