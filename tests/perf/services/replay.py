#!/usr/bin/python3
"""A life's monthly tests through the six services over DDS, all estimates included, and the same layers in one process
(--offline). Recordings: DIRECTORY's, else a life of 105 tests at 200 Hz that the virtual bench records first. No topic may
stand still because a reader does not take it, and the services must not take longer than one process does.
Usage: replay.py BIN_DIRECTORY [DIRECTORY]
"""
import pathlib
import resource
import subprocess
import sys
import tempfile
import time

from services import DOMAIN, SERVICES, SOURCE, Services, load, memory_MB

GOAL_RATIO, SETTLE_S = 1.0, 4.0
SHARED = SOURCE.parent / "shared/data/pst_life/xt03-mv2"


def recordings(binaries, folder):
    for directory in [pathlib.Path(word) for word in sys.argv[2:]] + [SHARED]:
        if files := sorted(directory.glob("**/*.csv")):
            return files, str(directory.name)
    subprocess.run([binaries / "sealwatch", "simulate", "--asset", SOURCE / "config/assets/xt03-mv2.yaml", "--ageing",
                    "--months", "105", "--out", folder / "life"], check=True, stdout=subprocess.DEVNULL)
    return sorted((folder / "life").glob("*.csv")), "recorded by the virtual bench"


def timed(command, environment=None):
    """Seconds on the wall, and of processor time of this process."""
    begin, before = time.monotonic(), resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run([str(word) for word in command], check=True, env=environment, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return time.monotonic() - begin, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def configuration(folder):
    """The repository's, in the benchmark's own domain."""
    (folder / "assets").symlink_to(SOURCE / "config/assets")
    text = (SOURCE / "config/sealwatch.yaml").read_text()
    (folder / "sealwatch.yaml").write_text(text.replace("domain: 0 ", f"domain: {DOMAIN} "))
    return folder


def main():
    binaries = pathlib.Path(sys.argv[1])
    with tempfile.TemporaryDirectory(prefix="sealwatch-perf-") as folder:
        folder = pathlib.Path(folder)
        files, origin = recordings(binaries, folder)
        print(f"replay: {len(files)} tests, {origin}; {load()}")
        config = configuration(folder)
        replay = [binaries / "sealwatch", "replay", "--config", config, "--quiet"]
        with open(folder / "stderr", "w+") as complaints, Services(binaries, config, stderr=complaints) as services:
            live_s, used_s = timed([*replay, *files], services.environment)
            shares = services.cpu_s()
            print(f"  six services over DDS  {live_s:6.1f} s, processor {used_s + sum(shares.values()):.1f} s: replay {used_s:.1f}, "
                  + ", ".join(f"{name} {shares[name]:.1f}" for name in SERVICES))
            time.sleep(SETTLE_S)
            complaints.seek(0)
            stalls = complaints.read().count("does not take its messages")
            print("  resident afterwards    " + ", ".join(
                f"{name} {memory_MB(services.processes[name].pid, 'VmRSS'):.1f}" for name in SERVICES) + " MB")
        offline_s, used_s = timed([*replay, "--offline", *files])
    print(f"  one process, offline   {offline_s:6.1f} s, processor {used_s:.1f} s; the services take {live_s / offline_s:.2f} times as long")
    met = stalls == 0 and live_s < GOAL_RATIO * offline_s
    print(f"  topics that stood still: {stalls}; goal: none, and not longer than one process: {'met' if met else 'MISSED'}")
    sys.exit(not met)


main()
