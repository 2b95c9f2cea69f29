"""The machine document: parts, rules, consistency, size, and what the names of its parameters say. It knows no rotor dynamics
and imports `bearings` only; every other room is given a parsed document.
"""
