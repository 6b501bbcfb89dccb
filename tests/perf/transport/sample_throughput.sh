#!/usr/bin/env bash
# sample_throughput.sh SAMPLE_THROUGHPUT: our blocks of 1000 doubles against ddsperf with the same payload, process to process on
# loopback, in turns; the median of the rounds' ratios must be at least 0.5. Ours carries header, channel names and units besides, and is
# decoded into RawSamples; ddsperf's payload is one octet sequence that it only counts.
set -euo pipefail
program=$1
seconds=2 rounds=7 payload=8000 goal=0.5
domain=97  # of its own: what others multicast in domain 0 would be received here too

export CYCLONEDDS_URI="<CycloneDDS><Domain Id=\"any\"><General><Interfaces><NetworkInterface name=\"lo\" multicast=\"true\"/>\
</Interfaces></General><Discovery><Tag>throughput-$$</Tag></Discovery></Domain></CycloneDDS>"
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT

ours() {
  "$program" subscribe "$seconds" >"$scratch/rate" &
  local subscriber=$!
  "$program" publish "$seconds"
  wait "$subscriber"
  cat "$scratch/rate"
}

# ddsperf prints for each second "rate 61.52 kS/s 3937.04 Mb/s"; the whole seconds between the first and the last line count.
theirs() {
  ddsperf -i $domain -1 -D $((seconds + 2)) sub >"$scratch/ddsperf" &
  local subscriber=$!
  ddsperf -i $domain -D $((seconds + 2)) -k all pub size $payload >/dev/null
  wait "$subscriber" || true
  sed -n 's/.* rate \([0-9.]*\) kS\/s.*/\1/p' "$scratch/ddsperf" | sort -n | awk '{r[NR]=$1} END {print 1000*r[int((NR+1)/2)]}'
}

# A machine that others share is fast for some seconds and slow for some: each round has a ratio of its own.
for _ in $(seq $rounds); do echo "$(ours) $(theirs)"; done |
  awk '{ print $1 / $2, $1, $2 }' | sort -n >"$scratch/rounds"
awk -v goal=$goal -v payload=$payload '{ ratio[NR] = $1; ours[NR] = $2; theirs[NR] = $3 } END {
  k = int((NR + 1) / 2)
  printf "sample transport: %.0f blocks/s (%.0f MB/s); ddsperf, %d octets: %.0f/s; ratio %.2f, %d rounds %.2f to %.2f (goal %.1f)\n",
         ours[k], ours[k] * payload * 1e-6, payload, theirs[k], ratio[k], NR, ratio[1], ratio[NR], goal
  exit !(ratio[k] >= goal) }' "$scratch/rounds"
