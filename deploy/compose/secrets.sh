#!/bin/sh
# Make the secrets that compose.yaml asks for, once; a file that is there already is kept. Run it as root in this folder:
# each file belongs to the user of the container that reads it, and to nobody else.
#
#   secrets.sh [HOST_OR_ADDRESS ...]     # by which sources outside reach the router
set -eu
umask 077
mkdir -p secrets
random() { head -c 24 /dev/urandom | base64 | tr '+/' '-_'; }
[ -e secrets/database_password ] || random > secrets/database_password
[ -e secrets/grafana_password ] || random > secrets/grafana_password
printf 'postgresql+psycopg://rundown:%s@postgresql/rundown\n' "$(cat secrets/database_password)" > secrets/database_url
[ -e secrets/sealing_key ] || head -c 32 /dev/urandom | base64 > secrets/sealing_key
[ -e secrets/metrics_key ] || : > secrets/metrics_key
[ -e secrets/authority.key ] || ../certificates.sh secrets authority
[ -e secrets/router.key ] || ../certificates.sh secrets router "$@"
[ -e secrets/rundown.key ] || ../certificates.sh secrets rundown
chmod 711 secrets && chmod 600 secrets/* && chmod 644 secrets/*.crt
chown 10001 secrets/database_url secrets/sealing_key secrets/router.key secrets/rundown.key # rundown
chown 65534 secrets/metrics_key # prometheus
chown 472 secrets/grafana_password # grafana
echo "secrets/ is ready; make the keys next: deploy/README.md"
