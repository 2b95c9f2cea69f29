#!/bin/sh
# Rundown by hand, from the folder of this project: files first, then a service. It writes into the folder `by-hand`.
set -eu
port=${PORT:-8080} stream=${STREAM:-tcp/127.0.0.1:7447}
mkdir by-hand

# Without a service: a simulated run-down as a file, what it says about the pump, and what changed later.
rundown sample examples/motor-pump.yaml by-hand/healthy.csv
rundown identify examples/motor-pump.yaml by-hand/healthy.csv
rundown model examples/motor-pump.yaml by-hand/healthy.csv
rundown sample examples/motor-pump.yaml:misalignment by-hand/later.csv --run-seed 2
rundown compare examples/motor-pump.yaml by-hand/healthy.csv by-hand/later.csv

# With a service, which goes on in the background: a machine, its run-down over zenoh, what was identified from it.
rundown serve --port "$port" --zenoh-listen "$stream" --database sqlite:///by-hand/rundown.db &
service=$!
trap 'kill $service; wait $service' EXIT
until curl -sf "localhost:$port/api/v1/ready" > by-hand/ready.json; do sleep 1; done
rundown document examples/motor-pump.yaml |
  curl -sSf -X POST "localhost:$port/api/v1/machines" -H 'content-type: application/json' -d @-
rundown replay by-hand/healthy.csv --speedup 100 --connect "$stream"
until curl -sSf "localhost:$port/api/v1/machines/motor-pump/identifications" | grep '"accepted":true'; do sleep 1; done
curl -sSf "localhost:$port/api/v1/machines/motor-pump/trends?parameter=coupling.C1.kxx"
rundown backup by-hand/monday.db --database sqlite:///by-hand/rundown.db
