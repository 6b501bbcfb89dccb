#!/usr/bin/python3
"""Resident memory and processor time of the six services, idle: no messages but heartbeats. The alternative: ddsperf,
idle in the same domain, as the smallest process with Cyclone DDS that there is.
Usage: idle.py BIN_DIRECTORY [SECONDS]
"""
import subprocess
import sys
import time

from services import Services, cpu_s, load, memory_MB

GOAL_MB, GOAL_PERCENT, SETTLE_S = 30.0, 1.0, 6.0


def main():
    seconds = float(sys.argv[2]) if len(sys.argv) > 2 else 20.0
    print(f"idle: six services for {seconds:.0f} s; {load()}")
    met = True
    with Services(sys.argv[1]) as services:
        bare = services.start(["ddsperf", "sanity"], stdout=subprocess.DEVNULL)
        processes = {name: process.pid for name, process in services.processes.items()}
        processes["(ddsperf sanity)"] = bare.pid
        time.sleep(SETTLE_S)
        before = {name: cpu_s(pid) for name, pid in processes.items()}
        time.sleep(seconds)
        for name, pid in processes.items():
            share = 100 * (cpu_s(pid) - before[name]) / seconds
            resident = memory_MB(pid, "VmRSS")
            print(f"  {name:22} {resident:5.1f} MB resident ({memory_MB(pid, 'RssAnon'):.1f} MB its own)  {share:.2f} % of a core")
            if pid != bare.pid:
                met = met and resident < GOAL_MB and share < GOAL_PERCENT
        bare.terminate()
    print(f"  goal: below {GOAL_MB:.0f} MB and {GOAL_PERCENT:.0f} %: {'met' if met else 'MISSED'}")
    sys.exit(not met)


main()
