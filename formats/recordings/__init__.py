"""Recorded runs in files: of Rundown, of spreadsheets, and of measuring systems, with sidecars that say what they hold. They
import `wire`, `files` and `measuring_systems`; samples go to the library, to publishers and to calibrations.
"""
