"""Advice on findings: what it is, how far, how sure, how urgent, what to check and to do; and the message of each event. It
imports `monitoring`, which declares the findings, `wording` and `alerts`; `delivery` and the API tell it.
"""
