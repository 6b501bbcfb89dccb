#!/usr/bin/env bash
# client_package.sh SOURCE_DIR BUILD_DIR SERVICES: see client_package.cmake.
set -euo pipefail
source_dir=$1 build_dir=$2 services=$3

scratch=$(mktemp -d)
started=()
cleanup() {
  for process in "${started[@]}"; do kill "$process" 2>/dev/null || true; done
  rm -rf "$scratch"
}
trap cleanup EXIT

fail() {
  echo "$1"
  shift
  for file in "$@"; do echo "--- $file"; cat "$file"; done
  exit 1
}

build_example() {
  { cmake -S "$source_dir/docs/examples/$1" -B "$scratch/$1" -DCMAKE_PREFIX_PATH="$scratch/prefix" &&
    cmake --build "$scratch/$1"; } >"$scratch/$1.log" 2>&1 ||
    fail "example $1 does not build against the installed package" "$scratch/$1.log"
}

# wait_for FILE LINES: until the file has as many lines, at most 20 s
wait_for() {
  for _ in $(seq 200); do
    [ "$(wc -l <"$1")" -ge "$2" ] && return
    sleep 0.1
  done
}

export CYCLONEDDS_URI="<CycloneDDS><Domain Id=\"any\"><General><Interfaces><NetworkInterface name=\"lo\" multicast=\"true\"/>\
</Interfaces></General><Discovery><Tag>client-package-$$</Tag></Discovery></Domain></CycloneDDS>"

lines=$(wc -l <"$source_dir/docs/examples/advisory_subscriber/main.cpp")
[ "$lines" -lt 40 ] || fail "the subscriber has $lines lines, it should have under 40"

cmake --install "$build_dir" --prefix "$scratch/prefix" --component client >"$scratch/install.log" ||
  fail "installing failed" "$scratch/install.log"
for idl in "$source_dir"/idl/*.idl; do
  cmp "$idl" "$scratch/prefix/share/sealwatch/idl/$(basename "$idl")"
done
build_example advisory_subscriber
build_example control_system
build_example sender

"$services" >"$scratch/received" &
started+=($!)
"$scratch/advisory_subscriber/advisory_subscriber" >"$scratch/advisories" 2>"$scratch/errors" &
subscriber=$!
started+=("$subscriber")
timeout 20 "$scratch/control_system/control_system" XT03-MV2 || fail "the control system could not send"
wait_for "$scratch/advisories" 2
wait_for "$scratch/received" 3
kill -INT "$subscriber"
wait "$subscriber" || fail "the subscriber did not end well after Ctrl-C" "$scratch/errors"

diff - "$scratch/advisories" <<'TEXT' || fail "the subscriber printed something else" "$scratch/errors"
XT03-MV2: high: Book a vessel for the replacement of XT03-MV2. (latest by 2031-04-21)
  because the seal reaches its threshold in 14 months
TEXT
diff - "$scratch/received" <<'TEXT' || fail "the control system sent something else"
XT03-MV2 2031-04-PST 0 begin: position[m] 200 of 200, from 0 s to 0.995 s
XT03-MV2 2031-04-PST 1 inside: position[m] 200 of 200, from 1 s to 1.995 s
XT03-MV2 2031-04-PST 2 end: position[m] 200 of 200, from 2 s to 2.995 s
TEXT
echo "the installed package builds and runs the examples"
