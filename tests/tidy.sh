#!/usr/bin/env bash
# clang-tidy with the repository's .clang-tidy, on as much as there is time for: 1 to 10 s of CPU a file.
#   tests/tidy.sh BUILD_DIR            source files that differ from the main branch, committed or not
#   tests/tidy.sh BUILD_DIR BASE       the same, from another base
#   tests/tidy.sh BUILD_DIR --all      the whole product, in the batches of a unity build where it is one: their headers
#                                      are read once (a quarter of an hour of CPU, else one hour)
#   tests/tidy.sh BUILD_DIR --rotating what the last commit changed, and the product in turn by the commit's hash, while
#                                      two minutes of CPU last
#   tests/tidy.sh BUILD_DIR --sample   a few files (a test of ctest, as the whole product has never been looked at)
# Exit status 1 where something is found. Needs the compile commands of a configured build.
set -euo pipefail
build=${1:?say which build directory}
cd "$(dirname "$0")/.."
command -v clang-tidy >/dev/null || { echo "not checked, as there is no clang-tidy"; exit 0; }

jobs=${SEALWATCH_TIDY_JOBS:-$(nproc)}
seconds=1000000  # of CPU
product() { sed -nE 's/^ *"file": "(.*\/services\/.*\.c(pp|xx))",?$/\1/p' "$build/compile_commands.json" | grep -v '/tests/' | sort -u; }
case ${2:-} in
  --all) mapfile -t files < <(product) ;;
  --sample)
    files=(services/common/core/time.cpp services/common/store/statements.cpp) ;;
  --rotating)
    seconds=120
    jobs=1
    commit=$(git rev-parse --verify -q HEAD 2>/dev/null || echo 0)
    # Of a copy without history nothing is known to have changed: the order by hash remains.
    mapfile -t changed < <({ git diff --name-only --diff-filter=d HEAD~1 -- 'services/*.cpp' || true; } 2>/dev/null)
    mapfile -t turn < <(product | while read -r file; do echo "$(echo "$commit $file" | cksum | cut -d' ' -f1) $file"; done | sort -n | cut -d' ' -f2)
    mapfile -t files < <(printf '%s\n' "${changed[@]}" "${turn[@]}" | awk 'NF && !seen[$0]++') ;;
  *)
    base=$(git merge-base HEAD "${2:-main}")
    mapfile -t files < <(git diff --name-only --diff-filter=d "$base" -- 'services/*.cpp') ;;
esac
[ ${#files[@]} -gt 0 ] || { echo "no source file has changed"; exit 0; }

# One line for each file that was looked at; nothing of those for which the time did not last.
looked=$(mktemp)
trap 'rm -f "$looked"' EXIT
export build looked seconds
look() {
  [ "$(awk '{ used += $1 } END { print int(used) }' "$looked")" -lt "$seconds" ] || return 0
  local status=0 spent TIMEFORMAT='%U %S'
  spent=$(mktemp)
  # A batch includes sources: that is what it is for. Of GCC's flags clang has not all.
  { time clang-tidy -p "$build" --quiet --checks=-bugprone-suspicious-include --extra-arg=-Wno-unknown-warning-option \
        --extra-arg=-Wno-unused-command-line-argument "$1" 2>/dev/null; } 2>"$spent" || { echo "found in $1"; status=1; }
  echo "$(tail -1 "$spent" | awk '{ print $1 + $2 }') $1" >>"$looked"
  rm -f "$spent"
  return $status
}
export -f look
printf '%s\n' "${files[@]}" | xargs -P "$jobs" -I{} bash -c 'look "$1"' _ {} || { echo "clang-tidy found the above"; exit 1; }
echo "clang-tidy finds nothing in $(wc -l <"$looked") of ${#files[@]} files"
