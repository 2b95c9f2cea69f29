"""The edge agent: it turns raw probe waveforms with a keyphasor into numbered samples of 1× and 2× phasors. It imports
`sources`, `wire` and `configuration`; what it publishes through a source with a log arrives in `ingest`."""
