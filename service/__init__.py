"""The service: takes in samples, monitors machines, alerts, and answers over HTTP. It may import `storage`, `estimator` and,
in its commands, `rotorundown`; of it only `configuration`, `sources` and `wire` are imported from outside, by `rotorundown`.
"""
