#!/usr/bin/env bash
# Configures and builds into build/<preset>. Everything stays inside the checkout, the compiler cache too.
#   deploy/build.sh release [--target TARGET] [cmake options...]
set -euo pipefail
cd "$(dirname "$0")/.."
preset=${1:-release}
shift || true
target=()
if [ "${1:-}" = --target ]; then target=(--target "$2"); shift 2; fi
export CCACHE_DIR="${CCACHE_DIR:-$PWD/build/ccache}" CCACHE_BASEDIR="$PWD" CCACHE_NOHASHDIR=1
echo "== build: build/$preset"
mkdir -p build
cmake --preset "$preset" "$@" >"build/$preset-configure.log" 2>&1 || { cat "build/$preset-configure.log" >&2; exit 1; }
cmake --build --preset "$preset" "${target[@]}"
