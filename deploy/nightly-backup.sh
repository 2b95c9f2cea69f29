#!/bin/sh
# A backup named by its moment, and then no more of those that are older than some days: of none before a new one is there.
# Run every night, by systemd/rundown-backup.timer, by cron in front of containers, or by Kubernetes.
#
#   nightly-backup.sh FOLDER [DAYS]     # a folder on another disk; by default two weeks are kept
set -eu
PATH=/opt/rundown/bin:$PATH
[ $# -ge 1 ] || { sed -n '2,5s/^# \{0,1\}//p' "$0" >&2; exit 2; }
folder=$1 days=${2:-14}
rundown backup "$folder/rundown-$(date -u +%Y-%m-%dT%H%M%SZ)"
find "$folder" -maxdepth 1 -type f -name 'rundown-*' -mtime "+$days" -exec rm -f {} +
