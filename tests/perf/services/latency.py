#!/usr/bin/python3
"""Acquisition-to-manipulation latency, live: 50 actuators at 200 Hz in blocks of 10 samples (1000 blocks a second).

From the instant of a block's last sample to
  hop          the raw block at a reader in another process, without data acquisition: what one DDS hop costs
  reader       the sample block at that reader, after data acquisition has judged, journaled and published it
  manipulation the same sample block in data manipulation, from that service's journal: the figure with the goal
Modes (live_latency.cpp): spread, as actuators are that do not share a clock, decides; together and endings are the worst
that can happen: 50 blocks at one instant, and 50 tests of which one ends every 0.6 s.
Usage: latency.py BIN_DIRECTORY [SECONDS]
"""
import pathlib
import sqlite3
import subprocess
import sys
import tempfile

from services import SOURCE, Services, load, quantile

ACTUATORS, GOAL_MS = 50, 20.0
TEST_S, SETTLE_S = 31.0, 2.0


def write_configuration(folder):
    text = (SOURCE / "config/assets/xt03-mv2.yaml").read_text()
    (folder / "assets").mkdir()
    (folder / "sealwatch.yaml").write_text((SOURCE / "config/sealwatch.yaml").read_text())
    for k in range(1, ACTUATORS + 1):
        (folder / f"assets/live-{k}.yaml").write_text(text.replace("asset_id: XT03-MV2", f"asset_id: LIVE-{k}"))


def measure(binaries, config, mode, seconds):
    """Latencies in ms by place, and the services' share of a core."""
    warm_up = TEST_S + SETTLE_S if mode == "endings" else SETTLE_S
    with Services(binaries, config, ["data-acquisition", "data-manipulation"]) as services:
        program = binaries / "perf/live_latency"
        reader = services.start([program, "receive", warm_up + seconds + 12], stdout=subprocess.PIPE, text=True)
        before = services.cpu_s()
        sender = services.start([program, "send", mode, ACTUATORS, warm_up + seconds])
        lines = [line.split() for line in reader.communicate()[0].splitlines()]
        if sender.wait() != 0 or reader.returncode != 0:
            sys.exit("latency: the blocks could not be sent or received")
        share = {name: 100 * (used - before[name]) / (warm_up + seconds) for name, used in services.cpu_s().items()}
        with sqlite3.connect(services.state / "data_manipulation.db") as journal:
            received = dict(journal.execute("SELECT message_id, received FROM inputs"))
    return latencies_ms(lines, received, warm_up), share


def latencies_ms(lines, received, warm_up):
    sampled = {(asset, block): int(sent) for topic, asset, _, block, sent, _ in lines if topic == "raw"}
    begin = min(sampled.values()) + int(warm_up * 1e9)
    places = {"hop": [], "reader": [], "manipulation": []}
    for topic, asset, message, block, _, arrived in lines:
        since = sampled[asset, block]
        if since < begin:
            continue
        places["hop" if topic == "raw" else "reader"].append((int(arrived) - since) * 1e-6)
        if topic == "block":
            places["manipulation"].append((received[message] - since) * 1e-6)
    if len({len(values) for values in places.values()}) != 1:
        sys.exit(f"latency: blocks were lost: { {place: len(values) for place, values in places.items()} }")
    return places


def main():
    binaries = pathlib.Path(sys.argv[1])
    seconds = float(sys.argv[2]) if len(sys.argv) > 2 else 20.0
    print(f"latency: {ACTUATORS} actuators, 200 Hz, blocks of 10 samples, {seconds:.0f} s; {load()}")
    met = True
    with tempfile.TemporaryDirectory(prefix="sealwatch-perf-") as folder:
        write_configuration(pathlib.Path(folder))
        for mode in ["spread", "together", "endings"]:
            places, share = measure(binaries, folder, mode, seconds)
            for place, values in places.items():
                p50, p99 = quantile(values, 0.5), quantile(values, 0.99)
                print(f"  {mode:8} {place:12} {len(values)} blocks  p50 {p50:6.2f}  p99 {p99:6.2f}  max {max(values):6.2f} ms")
            below = quantile(places["manipulation"], 0.99) < GOAL_MS
            print(f"  {mode:8} p99 in manipulation {'below' if below else 'ABOVE'} {GOAL_MS:.0f} ms")
            print(f"  {mode:8} " + ", ".join(f"{name} {used:.0f} %" for name, used in share.items()) + " of a core")
            met = met and (below or mode != "spread")
    print(f"  goal: p99 below {GOAL_MS:.0f} ms in manipulation, spread: {'met' if met else 'MISSED'}")
    sys.exit(not met)


main()
