#!/usr/bin/env bash
# Runs every benchmark, one after the other, each with its alternative in the same run. Exit status 1 where a goal is missed.
#   tests/perf/run.sh [BUILD_DIRECTORY]    default build/release; takes about ten minutes
# Everything else on the machine distorts the figures; `nice -n -15 tests/perf/run.sh` (root) keeps most of it out.
set -uo pipefail
here=$(cd "$(dirname "$0")" && pwd)
bin=${1:-$here/../../build/release}/bin
missed=0

measure() { "$@" || missed=1; }

echo "== $(date -u +%F): $(nproc) cores, $(sed -n 's/model name[^:]*: //p' /proc/cpuinfo | head -1), load $(cut -d' ' -f1 /proc/loadavg)"
measure "$bin/perf/estimation_benchmark" --benchmark_filter=cylinder
measure "$bin/perf/sensitivity_benchmark"
measure "$bin/perf/row_products_benchmark"
measure "$bin/perf/fmu_call_benchmark"
measure "$bin/perf/text_plant_benchmark"
measure "$here/services/replay.py" "$bin"
measure "$here/transport/sample_throughput.sh" "$bin/perf/sample_throughput"
measure "$here/services/latency.py" "$bin"
measure "$here/services/idle.py" "$bin"
measure "$here/verification/lives.py" "$bin"
[ $missed -eq 0 ] && echo "== every goal is met" || echo "== a goal was MISSED, see above"
exit $missed
