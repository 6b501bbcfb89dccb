#!/usr/bin/env bash
# client_package.sh SOURCE_DIR BUILD_DIR PUBLISHER: see client_package.cmake.
set -euo pipefail
source_dir=$1 build_dir=$2 publisher=$3

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

export CYCLONEDDS_URI="<CycloneDDS><Domain Id=\"any\"><General><Interfaces><NetworkInterface name=\"lo\" multicast=\"true\"/>\
</Interfaces></General><Discovery><Tag>client-package-$$</Tag></Discovery></Domain></CycloneDDS>"

example=$source_dir/docs/examples/advisory_subscriber
lines=$(wc -l <"$example/main.cpp")
[ "$lines" -lt 40 ] || fail "the example has $lines lines, it should have under 40"

cmake --install "$build_dir" --prefix "$scratch/prefix" --component client >"$scratch/install.log" ||
  fail "installing failed" "$scratch/install.log"
for idl in "$source_dir"/idl/*.idl; do
  cmp "$idl" "$scratch/prefix/share/sealwatch/idl/$(basename "$idl")"
done
{ cmake -S "$example" -B "$scratch/build" -DCMAKE_PREFIX_PATH="$scratch/prefix" && cmake --build "$scratch/build"; } \
  >"$scratch/build.log" 2>&1 || fail "the example does not build against the installed package" "$scratch/build.log"

"$publisher" &
started+=($!)
"$scratch/build/advisory_subscriber" >"$scratch/output" 2>"$scratch/errors" &
subscriber=$!
started+=("$subscriber")

for _ in $(seq 200); do
  grep -q because "$scratch/output" && break
  sleep 0.1
done
kill -INT "$subscriber"
wait "$subscriber" || fail "the example did not end well after Ctrl-C" "$scratch/errors"

cat >"$scratch/expected" <<'TEXT'
XT03-MV2: high: Book a vessel for the replacement of XT03-MV2. (latest by 2031-04-21)
  because the seal reaches its threshold in 14 months
TEXT
diff "$scratch/expected" "$scratch/output" || fail "the example printed something else" "$scratch/errors"
echo "the installed package builds and runs the example"
