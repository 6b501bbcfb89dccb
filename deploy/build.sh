#!/usr/bin/env bash
# Configures and builds into build/<preset>. Everything stays inside the checkout, the compiler cache too.
#   deploy/build.sh release [cmake options...]
set -euo pipefail
cd "$(dirname "$0")/.."
preset=${1:-release}
shift || true
export CCACHE_DIR="${CCACHE_DIR:-$PWD/build/ccache}"
echo "== build: build/$preset"
cmake --preset "$preset" "$@" >"build-$preset.log" 2>&1 || { cat "build-$preset.log"; exit 1; }
mkdir -p build && mv "build-$preset.log" "build/$preset-configure.log"
cmake --build --preset "$preset"
