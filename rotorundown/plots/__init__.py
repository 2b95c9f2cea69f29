"""Plots of the trade, drawn with matplotlib: Bode, polar, orbit, shaft centreline, Campbell, train, trend. They import
`environment` and `estimator`, and are given results by the library. Units are those of plants: r/min, µm pp, phase lag.
"""
