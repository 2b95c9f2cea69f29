"""Histories of parameters in columns, thinned out and in the units asked for. It imports `conventions`, `cache` and
`monitoring`.
"""
