#!/bin/sh
# The router of a plant: its sources connect to it, it connects to the centre and goes on trying while that is away.
# What comes meanwhile waits in the sources' durable logs (docs/edge.md), which are asked for it afterwards.
set -eu
export RUNDOWN_ZENOH_TLS_CA=/etc/rundown/tls/authority.crt
export RUNDOWN_ZENOH_TLS_CERTIFICATE=/etc/rundown/tls/router-harbour.crt
export RUNDOWN_ZENOH_TLS_KEY=/etc/rundown/tls/router-harbour.key
export RUNDOWN_ZENOH_ACCESS=/etc/rundown/access.yaml
exec /opt/rundown/bin/rundown router --listen tls/0.0.0.0:7447 --connect tls/centre.example:7447
