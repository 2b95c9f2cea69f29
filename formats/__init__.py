"""Formats in which samples and documents come in and go out, without any service: wire, recordings, files. Its rooms build on
`storage`, for its sample blocks and its clock, and on `estimator`; `rotorundown` and `service` read and write with them.
"""
