#!/usr/bin/env bash
# demo.sh [--stop] [BUILD]: starts the daemon, uploads a sample, asks real questions with curl, prints the answers and the URL to open.
# The daemon goes on in the background; --stop ends it. GEODESICD_LISTEN chooses another address.
set -euo pipefail

stop=false
if [ "${1:-}" = --stop ]; then
    stop=true
    shift
fi
build=${1:-build}
run=$build/demo
mkdir -p "$run"

stop_daemon() {
    [ -f "$run/pid" ] || return 0
    kill "$(cat "$run/pid")" 2>/dev/null || true
    rm -f "$run/pid"
}

# The daemon's own log line says where it listens.
address() {
    sed -n 's/.*"event":"listening".*"address":"\([^"]*\)".*/\1/p' "$run/log" | tail -n 1
}

start_daemon() {
    nohup "$build/geodesicd" --data-dir "$run/data" "$@" </dev/null >"$run/log" 2>&1 &
    echo $! >"$run/pid"
    for _ in $(seq 100); do
        [ -z "$(address)" ] || return 0
        kill -0 "$(cat "$run/pid")" 2>/dev/null || return 1
        sleep 0.05
    done
    return 1
}

# Shows a call as a person would type it, makes it, shows the answer.
ask() {
    printf '\n$ curl'
    for word in "$@"; do
        case $word in
        *[!A-Za-z0-9/:._-]*) printf " '%s'" "$word" ;;
        *) printf ' %s' "$word" ;;
        esac
    done
    printf '\n'
    curl --silent --show-error --fail-with-body "$@"
    echo
}

stop_daemon
$stop && exit 0

# The usual port, or any free one when something else has it.
start_daemon || start_daemon --listen 127.0.0.1:0 || {
    cat "$run/log" >&2
    exit 1
}
url=http://$(address)

"$build/gd_sample" genus2 >"$run/genus2.obj"
ask -T "$run/genus2.obj" "$url/v1/meshes/demo"
ask "$url/v1/meshes/demo/distance?from=v:12&to=v:2000"
ask "$url/v1/meshes/demo/path?from=v:12&to=p:0.5,0.5,1&geometry=xyz"
ask -d '{"from":{"face":34,"barycentric":[0.2,0.3,0.5]},"to":{"vertex":900}}' -H 'Content-Type: application/json' \
    "$url/v1/meshes/demo/distance"
ask "$url/v1/meshes/demo/nearest?point=p:0,0,5"

echo
echo "geodesicd is running (process $(cat "$run/pid"), log $run/log). Open $url/ in a browser; stop it by: make demo-stop"
