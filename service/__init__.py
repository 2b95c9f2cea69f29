"""The service: takes in samples, monitors machines, alerts, and answers over HTTP. It may import `storage` and `estimator`;
nothing imports it.
"""
