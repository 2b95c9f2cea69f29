"""The edge agent: raw probe waveforms with a keyphasor in, numbered samples of 1× and 2× phasors out.

`configuration.py` says what is measured; `files.py` and `topic.py` deliver chunks of waveforms; `blocks.py` cuts them into
blocks and has the estimator turn each into phasors; `agent.py` publishes them through a source with a log; `condition.py`
names everything that can be wrong on the way.
"""
