"""Diagnosis of a machine: kinds of findings, hypotheses, their evidence over windows of runs, the size of a change. It
imports `trends`, `rotor`, `fit` with its `problem`, `validation` and `omitted_errors`, `machine`, and for trains on oil films
`alignment`, `updated_model` and `statics`; the service's monitoring makes findings and alerts of its causes.
"""
