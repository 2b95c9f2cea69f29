"""The service: takes in samples, monitors machines, alerts, and answers over HTTP. It may import `storage`, `estimator`,
`formats` and `rotorundown`; nothing of it is imported from outside.
"""
