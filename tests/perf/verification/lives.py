#!/usr/bin/python3
"""Cost of `sealwatch verify rul`: does it grow linearly with the lives, what does the second core gain, and would 1000
lives end within the goal? Runs 20, 40 and 80 lives with one thread and with two; the alternative to two threads is one.
Usage: lives.py BIN_DIRECTORY [ASSET_FILE]

Processor seconds hold on a shared machine too; seconds by the clock, and so the gain, only on an idle one.
"""
import json
import os
import subprocess
import sys
import tempfile

GOAL_S, GOAL_MB, GOAL_LIVES = 600.0, 1024.0, 1000
LIVES, THREADS = (20, 40, 80), (1, 2)
LEAST_GAIN = 1.6  # of the second core; asked for on an idle machine alone
LINEAR = 0.15     # share that the cost of a test may differ by between 20 and 80 lives


def run(binary, asset, lives, threads, folder):
    out = os.path.join(folder, f"{lives}-{threads}")
    subprocess.run([binary, "verify", "rul", "--asset", asset, "--lives", str(lives), "--threads", str(threads), "--out", out],
                   check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    with open(os.path.join(out, "results.json"), "rb") as results:
        answer = results.read()
    with open(os.path.join(out, "cost.json")) as cost:
        return json.load(cost), answer


def main():
    binary = os.path.join(sys.argv[1], "sealwatch")
    here = os.path.dirname(os.path.abspath(__file__))
    asset = sys.argv[2] if len(sys.argv) > 2 else os.path.join(here, "../../../config/assets/xt03-mv2.yaml")
    load = os.getloadavg()[0]
    print(f"verify rul: {', '.join(map(str, LIVES))} lives, circuit at 50 Hz through the layers, all forecasters; load {load:.1f}")
    print("  lives threads    tests  seconds  processor s  s a life  ms a test  memory MB")
    costs, met = {}, True
    with tempfile.TemporaryDirectory() as folder:
        for lives in LIVES:
            answers = set()
            for threads in THREADS:
                cost, answer = run(binary, asset, lives, threads, folder)
                costs[lives, threads] = cost
                answers.add(answer)
                cpu = cost["processor_seconds"]
                print(f"  {lives:5} {threads:7} {cost['tests']:8} {cost['seconds']:8.1f} {cpu:12.1f} {cpu / lives:9.3f} "
                      f"{1e3 * cpu / cost['tests']:10.2f} {cost['largest_memory_MB']:10.1f}")
            met = met and len(answers) == 1  # threads change no byte
    most = costs[LIVES[-1], 1]
    each = [costs[lives, 1]["processor_seconds"] / costs[lives, 1]["tests"] for lives in LIVES]
    growth = each[-1] / each[0]
    gain = most["seconds"] / costs[LIVES[-1], 2]["seconds"]
    processor = costs[LIVES[-1], 2]["processor_seconds"] / most["processor_seconds"]
    cpu_1000 = most["processor_seconds"] / LIVES[-1] * GOAL_LIVES
    clock_1000 = costs[LIVES[-1], 2]["seconds"] / LIVES[-1] * GOAL_LIVES
    memory = max(cost["largest_memory_MB"] for cost in costs.values())
    idle = load < 0.5
    print(f"  a test costs {growth:.2f} times as much with {LIVES[-1]} lives as with {LIVES[0]} (1: linear)")
    print(f"  two threads: {gain:.2f} times as fast by the clock, {processor:.2f} times the processor time"
          f"{'' if idle else ' (machine not idle: the gain means nothing)'}")
    print(f"  {GOAL_LIVES} lives, extrapolated: {cpu_1000:.0f} processor s, so {cpu_1000 / 2:.0f} s on two free cores; "
          f"by the clock as it was here {clock_1000:.0f} s")
    met = met and abs(growth - 1.0) < LINEAR and cpu_1000 / 2 < GOAL_S and memory < GOAL_MB
    met = met and (not idle or (gain > LEAST_GAIN and clock_1000 < GOAL_S))
    print(f"  goal: {GOAL_S:.0f} s and {GOAL_MB:.0f} MB, linear, the same results with two threads: {'met' if met else 'MISSED'}")
    sys.exit(not met)


main()
