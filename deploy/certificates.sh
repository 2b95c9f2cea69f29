#!/bin/sh
# Certificates for the zenoh network: an authority, and one certificate for each name (its common name, by which
# RUNDOWN_ZENOH_ACCESS says what it may do). Needs openssl 1.1.1 or newer.
#
#   certificates.sh FOLDER authority                     # once; keep authority.key away from the network
#   certificates.sh FOLDER NAME [HOST_OR_ADDRESS ...]    # hosts: where it can be reached, for what listens
set -eu
umask 077
DAYS_AUTHORITY=3650
DAYS=${DAYS:-397}

[ $# -ge 2 ] || { sed -n '2,7s/^# \{0,1\}//p' "$0" >&2; exit 2; }
folder=$1 name=$2
shift 2
mkdir -p "$folder"
cd "$folder"
case $name in *[!A-Za-z0-9_.-]*|''|-*|.*) echo "the name must consist of letters, digits, _ . and -" >&2; exit 2 ;; esac
[ ! -e "$name.key" ] || { echo "$folder/$name.key is there already: move it away first" >&2; exit 1; }

openssl ecparam -name prime256v1 -genkey -noout | openssl pkcs8 -topk8 -nocrypt -out "$name.key"
if [ "$name" = authority ]; then
    openssl req -x509 -new -key authority.key -sha256 -days "$DAYS_AUTHORITY" -subj "/CN=Rundown authority" \
        -addext "keyUsage=critical,keyCertSign,cRLSign" -out authority.crt
else
    [ -e authority.key ] || { echo "make the authority first: certificates.sh $folder authority" >&2; exit 1; }
    names="DNS:$name"
    for host in "$@"; do
        case $host in
            *[!0-9.:a-fA-F]*) names="$names,DNS:$host" ;;
            *.*.*.*|*:*) names="$names,IP:$host" ;;
            *) names="$names,DNS:$host" ;;
        esac
    done
    openssl req -new -key "$name.key" -subj "/CN=$name" -out "$name.csr"
    printf 'basicConstraints=critical,CA:FALSE\nkeyUsage=critical,digitalSignature\nextendedKeyUsage=serverAuth,clientAuth\nsubjectAltName=%s\n' \
        "$names" > "$name.ext"
    openssl x509 -req -in "$name.csr" -CA authority.crt -CAkey authority.key -CAcreateserial -sha256 -days "$DAYS" \
        -extfile "$name.ext" -out "$name.crt" 2>/dev/null
    rm "$name.csr" "$name.ext"
fi
chmod 644 "$name.crt"
echo "$folder/$name.crt, $folder/$name.key"
