#!/usr/bin/env bash
# demo.sh [--stop] [BUILD]: starts the daemon, uploads a sample, sends queries with curl, and prints
# the answers and the addresses to open. The daemon continues in the background; --stop ends it.
# GEODESICD_LISTEN sets the daemon's address.
set -euo pipefail

stop=false
if [ "${1:-}" = --stop ]; then
    stop=true
    shift
fi
build=${1:-build}
run=$build/demo

# Returns whether the process whose id is in the pid file is the demo's daemon. Compares the command
# line, because the system reuses process ids.
is_running() {
    [ -f "$run/pid" ] && tr '\0' ' ' <"/proc/$(cat "$run/pid")/cmdline" 2>/dev/null | grep -qF -- "--data-dir $run/data"
}

stop_daemon() {
    if is_running; then
        kill "$(cat "$run/pid")"
        for _ in $(seq 100); do
            is_running || break
            sleep 0.05
        done
    fi
    rm -f "$run/pid"
}

# Prints the address at which the daemon listens, from its log.
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

fail() {
    rm -f "$run/pid"
    tail -n 3 "$run/log" >&2
    echo "$*" >&2
    exit 1
}

# ask TEXT CURL-ARGUMENT...: prints the text, the curl command as a user would type it, and the
# beginning of the answer.
ask() {
    printf '\n# %s\n$ curl' "$1"
    shift
    for word in "$@"; do
        case $word in
        *[!A-Za-z0-9/:._-]*) printf " '%s'" "$word" ;;
        *) printf ' %s' "$word" ;;
        esac
    done
    local answer
    answer=$(curl --silent --show-error --fail-with-body "$@")
    if [ ${#answer} -gt 240 ]; then
        printf '\n%s … (%d bytes)\n' "${answer:0:240}" ${#answer}
    else
        printf '\n%s\n' "$answer"
    fi
}

was_running=false
is_running && was_running=true
stop_daemon
if $stop; then
    $was_running && echo "The demo's daemon has ended." || echo "The demo's daemon was not running."
    exit 0
fi

mkdir -p "$run"
if ! start_daemon; then
    [ -z "${GEODESICD_LISTEN:-}" ] || fail "The daemon could not listen on GEODESICD_LISTEN=$GEODESICD_LISTEN: name another address, or leave it out for any free port."
    start_daemon --listen 127.0.0.1:0 || fail "The daemon did not start; its log is $run/log."
    echo "Port 8080 is taken, so the demo listens on $(address)."
fi
url=http://$(address)

"$build/gd_sample" genus2 >"$run/genus2.obj"
ask "Upload a mesh: a surface with two holes." -T "$run/genus2.obj" "$url/v1/meshes/demo"
ask "The exact distance from one vertex to another." "$url/v1/meshes/demo/distance?from=v:12&to=v:2000"
ask "The shortest path from a vertex to the surface point nearest to a point of space." \
    "$url/v1/meshes/demo/path?from=v:12&to=p:0.5,0.5,1&geometry=xyz"
ask "The same question as JSON, from a point inside a face." -d '{"from":{"face":34,"barycentric":[0.2,0.3,0.5]},"to":{"vertex":900}}' \
    -H 'Content-Type: application/json' "$url/v1/meshes/demo/distance"
ask "The surface point nearest to a point of space." "$url/v1/meshes/demo/nearest?point=p:0,0,5"

cat <<END

geodesicd is running (process $(cat "$run/pid"), log $run/log). Open in a browser:
    $url/       the viewer: click two points, or drop a mesh of yours
    $url/docs   every operation, to be tried out
    $url/v1/meshes/demo/picture.png?source=v:12&from=v:12&to=v:1500
The command line: GEODESICD_URL=$url clients/cli/geodesic distance demo v:12 v:2000
To end it: make demo-stop
END
