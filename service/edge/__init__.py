"""The edge agent: raw probe waveforms with a keyphasor in, numbered samples of 1× and 2× phasors out. It imports `sources`,
`wire` and `configuration`; what it publishes through a source with a log arrives in `ingest`.
"""
