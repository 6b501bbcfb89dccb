#!/usr/bin/env bash
# Configures and builds into build/<preset>. Everything stays inside the checkout, the compiler cache too.
#   deploy/build.sh release [--target TARGET] [cmake options...]
set -euo pipefail
cd "$(dirname "$0")/.."
preset=${1:-release}
shift || true
target=()
if [ "${1:-}" = --target ]; then target=(--target "$2"); shift 2; fi
# Depend mode: files that the cache does not know yet are not preprocessed once more to ask for them.
export CCACHE_DIR="${CCACHE_DIR:-$PWD/build/ccache}" CCACHE_BASEDIR="$PWD" CCACHE_NOHASHDIR=1 CCACHE_DEPEND=1
echo "== build: build/$preset"
mkdir -p build
# From nothing, several files at once: half the time. A folder that is there keeps what it was made with, as turning this
# on or off compiles everything anew. For daily work (one change, one file) there is the preset `dev`.
if [ "$preset" = release ] && [ ! -f build/release/CMakeCache.txt ]; then set -- -DSEALWATCH_UNITY=ON "$@"; fi
cmake --preset "$preset" "$@" >"build/$preset-configure.log" 2>&1 || { cat "build/$preset-configure.log" >&2; exit 1; }
cmake --build --preset "$preset" "${target[@]}"
