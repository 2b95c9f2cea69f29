"""The plant's MQTT broker: samples in, also as Sparkplug B, alerts and trends out.

Started, and its library imported, only where a broker is configured. It imports `write_path`, whose queue takes the samples,
`wire`, `configuration`, `replication`, `resilience`, `advice` and `alerts`; what it publishes it reads from the store.
"""
