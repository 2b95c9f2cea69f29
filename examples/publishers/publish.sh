#!/bin/sh
# A source without zenoh: sends one sample at a time over HTTP, each again until it is stored. Needs curl.
#   sh publish.sh http://127.0.0.1:8080 examples motor-pump B1L 20      # service, plant, machine, channel, samples
set -eu
url=$1 plant=$2 machine=$3 channel=$4 samples=$5
answer=$(mktemp)
trap 'rm -f "$answer"' EXIT
epoch=$(date +%s%N)
sequence=0
while [ "$sequence" -lt "$samples" ]; do
    # Here the instrument would be read.
    speed=1480.0 amplitude=25.0 phase=120.0
    status=$(curl --silent --show-error --header 'Content-Type: application/json' --data @- --output "$answer" \
        --write-out '%{http_code}' "$url/api/v1/machines/$machine/samples" <<JSON
{"schema": 1, "plant": "$plant", "machine": "$machine", "source": "shell", "epoch": $epoch, "sequence": $sequence,
 "channels": ["$channel"], "speed_unit": "rpm", "amplitude_unit": "um", "amplitude_kind": "peak-to-peak",
 "phase_convention": "lag", "phase_unit": "deg", "direction": "positive",
 "time_ns": [$(date +%s%N)], "speed": [$speed], "amplitude": [[$amplitude]], "phase": [[$phase]]}
JSON
    ) || status=000
    case $status in
        2??) sequence=$((sequence + 1)) ;;
        000 | 429 | 5??) sleep 1 ;; # away, or not well for the moment: the same number again
        *) cat "$answer" >&2; exit 1 ;; # said so for good
    esac
done
