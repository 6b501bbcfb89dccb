#!/usr/bin/env bash
# clang-tidy with the repository's .clang-tidy, on as much as there is time for: 1 to 6 s a file.
#   tests/tidy.sh BUILD_DIR           source files that differ from the main branch, committed or not
#   tests/tidy.sh BUILD_DIR BASE      the same, from another base
#   tests/tidy.sh BUILD_DIR --sample  one file of each kind (a test of ctest)
# Exit status 1 where something is found. Needs the compile commands of a configured build.
set -euo pipefail
build=${1:?say which build directory}
cd "$(dirname "$0")/.."
command -v clang-tidy >/dev/null || { echo "not checked, as there is no clang-tidy"; exit 0; }

sample=(
  services/common/core/time.cpp               # plain types
  services/common/signal/alignment.cpp        # mathematics
  services/common/store/statements.cpp        # SQL
  services/data_manipulation/conclude_test.cpp  # a layer
)
if [ "${2:-}" = --sample ]; then
  files=("${sample[@]}")
else
  base=$(git merge-base HEAD "${2:-main}")
  mapfile -t files < <(git diff --name-only --diff-filter=d "$base" -- 'services/*.cpp')
fi
[ ${#files[@]} -gt 0 ] || { echo "no source file has changed"; exit 0; }

printf '%s\n' "${files[@]}" |
  xargs -P "$(nproc)" -I{} sh -c 'clang-tidy -p "$1" --quiet "$2" 2>/dev/null || { echo "found in $2"; exit 1; }' _ "$build" {} ||
  { echo "clang-tidy found the above"; exit 1; }
echo "clang-tidy finds nothing in ${#files[@]} files"
