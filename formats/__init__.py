"""Formats in which data and documents come from outside and go there, without any service. They import `storage`, for its sample
blocks and its clock, and `estimator`; `rotorundown` and `service` read and write by them.
"""
