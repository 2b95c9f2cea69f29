"""Advice on findings: what it is, how far, how sure, how urgent, what to check and to do; and the message of each event. It
imports `rules`, where the findings are declared, `wording` and `alerts`; `delivery` and the API send it out.
"""
