"""Field balancing told to the person beside the machine: as text, as vector plots, and as one printed page. It imports the
estimator, `wording` and the `rules` of alerts, and reads runs and alerts from the store; the command `rundown balance` and
the API call it.
"""
