"""The science of Rundown: pure functions on arrays; no input or output, no clock, no other package of the project.

Its ground floor (array types, units, errors, strict documents) imports no room; every room may import it. From documents and
phasors come identifications, from these updated models, trends and diagnoses.
"""
