#!/usr/bin/env bash
# Installs, builds and runs every test of sealwatch. The last lines are ctest's own summary.
#   tests/run.sh                 everything
#   tests/run.sh -R forecast     builds everything; what follows goes to ctest
# One program alone: deploy/build.sh release -DSEALWATCH_TESTS=ON --target forecast_test
#                    ctest --test-dir build/release -R '^forecast_test'
set -euo pipefail
case "${1:-}" in
  -h | --help)
    sed -n '2,/^set/{/^#/s/^# \?//p}' "$0"
    exit
    ;;
esac
cd "$(dirname "$0")/.."
deploy/install_packages.sh test
deploy/build.sh release -DSEALWATCH_TESTS=ON
cd build/release
# Two more than there are cores: those that wait run beside those that compute (deploy/cmake/sealwatch.cmake).
exec ctest --output-on-failure --parallel "$(($(nproc) + 2))" "$@"
