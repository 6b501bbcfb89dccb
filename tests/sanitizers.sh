#!/usr/bin/env bash
# Builds and runs the tests under both sanitizer presets, and writes a line of each into docs/records/sanitizers.tsv:
# commit, date (UTC), preset, tests passed, tests failed, seconds, and which failed.
#   tests/sanitizers.sh                        everything but the fuzzers: about an hour of building each on two cores
#   tests/sanitizers.sh services               the six services alone, under each fault of the campaign
#   tests/sanitizers.sh quick                  what reads foreign text and messages, under asan-ubsan: two minutes
#   tests/sanitizers.sh quick --check          the same and no record: a test of ctest
#   tests/sanitizers.sh -L unit -R '^core_'    what follows goes to ctest; such a part of the tests is not recorded
# Exit status 1 where a test fails or a build does. Refuses to record a tree with uncommitted changes to tracked files.
set -uo pipefail
cd "$(dirname "$0")/.."
record=docs/records/sanitizers.tsv
commit=$(git rev-parse --short HEAD 2>/dev/null) || commit=""
part="" targets=(all) folder_end="" settings=() presets=(asan-ubsan tsan) records=yes
if [ "${1:-}" = services ]; then
  part=" services" targets=(campaign_programs) folder_end=-services
  # The engine computes alone, in no test of how processes meet: without it a build takes a quarter of the time.
  settings=(-D SEALWATCH_SANITIZE_ENGINE=OFF)
  # What was freed is kept for a while, to tell a use of it: by default 256 MB of it, which would count as what a flood
  # makes a service take.
  export ASAN_OPTIONS="quarantine_size_mb=4${ASAN_OPTIONS:+:$ASAN_OPTIONS}"
  set -- -R '^campaign_'
elif [ "${1:-}" = quick ]; then
  [ "${2:-}" != --check ] || records=
  part=" quick" folder_end=-quick presets=(asan-ubsan) targets=(core_test text_test message_test units_test)
  settings=(-D SEALWATCH_UNITY=ON)
  set -- -R '^(core|text|message|units)_test$'
fi
[ $# -eq 0 ] || [ -n "$part" ] || records=
if [ -n "$records" ] && { [ -z "$commit" ] || ! git diff --quiet HEAD -- . ":!$record"; }; then
  echo "commit first: the record names the commit that was tested" >&2
  exit 2
fi
[ "$part" = " quick" ] || deploy/install_packages.sh test || exit 2
export TSAN_OPTIONS="suppressions=$PWD/tests/tsan.supp die_after_fork=0 report_thread_leaks=0"
failed=0
for preset in "${presets[@]}"; do
  begin=$(date +%s)
  log=$(mktemp)
  passed=0 broken=0 which="does not build"
  folder=build/$preset$folder_end
  if cmake --preset "$preset" -B "$folder" "${settings[@]}" && cmake --build "$folder" --target "${targets[@]}"; then
    ctest --test-dir "$folder" --output-on-failure -LE fuzz --parallel "$(nproc)" "$@" | tee "$log"
    total=$(sed -n 's/.*tests passed, .* tests failed out of \([0-9]*\)$/\1/p' "$log")
    broken=$(sed -n 's/.*tests passed, \([0-9]*\) tests failed out of .*/\1/p' "$log")
    passed=$((${total:-0} - ${broken:-0}))
    which=$(awk '/^The following tests FAILED:/ { list = 1; next } list && /^\t/ { printf "%s%s", sep, $3; sep = " " }' "$log")
    [ "${total:-0}" -gt 0 ] || which="no test ran"
  fi
  rm -f "$log"
  [ -z "$which" ] || failed=1
  line="$commit\t$(date -u +%FT%TZ)\t$preset$part\t$passed\t${broken:-0}\t$(($(date +%s) - begin))\t${which:--}"
  echo -e "$line"
  [ -z "$records" ] || echo -e "$line" >>"$record"
done
exit $failed
