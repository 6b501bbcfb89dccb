#!/usr/bin/python3
"""How long services take to be ready on the journals of a long history, and how much memory they then have. A few months of
one actuator are recorded and concluded; their rows, with other names and dates, make the history of many. The dates are
those of monthly tests; samples older than the last month are dropped, as retention does.
Usage: start_up.py BIN_DIRECTORY [ASSETS [YEARS [SERVICE...]]]
"""
import os
import pathlib
import shutil
import socket
import subprocess
import sys
import tempfile
import time

from services import DOMAIN, SOURCE, cpu_s, load, memory_MB, uri

GOAL_S, RECALLS_S, MONTHS, ASSET = 20.0, float(os.environ.get("RECALLS_S", 300)), 12, "XT03-MV2"
SERVICES = ["state_detection", "health_assessment", "prognostic_assessment", "advisory_generation", "data_manipulation",
            "data_acquisition"]


def record(binaries, folder):
    """The journals of a year of one actuator."""
    environment = dict(os.environ, CYCLONEDDS_URI=uri(f"start-up-{os.getpid()}"))
    run = lambda *words: subprocess.run([str(w) for w in words], env=environment, check=True, stdout=subprocess.DEVNULL)
    run(binaries / "sealwatch", "simulate", "--asset", SOURCE / "config/assets/xt03-mv2.yaml", "--months", MONTHS, "--rate", 20,
        "--out", folder / "life")
    run(binaries / "sealwatch", "replay", "--quiet", "--with-services", "--config", SOURCE / "config", "--state", folder / "one",
        *sorted((folder / "life").glob("*.csv")))


def configuration(folder, assets):
    """As for the one asset, with a file for each of many."""
    shutil.copytree(SOURCE / "config", folder)
    one = (folder / "assets/xt03-mv2.yaml").read_text()
    for number in range(assets):
        name = f"A{number:04}"
        (folder / f"assets/{name.lower()}.yaml").write_text(one.replace(ASSET, name))
    return folder


def start(binaries, service, config, state):
    """Seconds until it says that it is ready (and of a processor), until it has recalled all, and its memory."""
    with tempfile.TemporaryDirectory() as folder:
        listener = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
        listener.bind(folder + "/notify")
        listener.settimeout(1200)
        environment = dict(os.environ, NOTIFY_SOCKET=folder + "/notify", CYCLONEDDS_URI=uri(f"start-up-{os.getpid()}-{service}"))
        begin = time.monotonic()
        with subprocess.Popen([str(binaries / f"sealwatch-{service.replace('_', '-')}"), "--config", str(config), "--state",
                               str(state), "--domain", str(DOMAIN)], env=environment, stderr=subprocess.DEVNULL) as process:
            while b"READY=1" not in listener.recv(4096):
                pass
            figures = {"ready_s": time.monotonic() - begin, "ready_cpu_s": cpu_s(process.pid),
                       "ready_MB": memory_MB(process.pid, "RssAnon"), "read_MB": read_MB(process.pid)}
            while time.monotonic() - begin < RECALLS_S:
                text = "".join(file.read_text() for file in (state / "log").glob(f"*{service}*"))
                if "is recalled" in text:
                    break
                time.sleep(0.2)
            figures |= {"recalled_s": time.monotonic() - begin, "recalled_cpu_s": cpu_s(process.pid), "all_MB": memory_MB(process.pid, "RssAnon"),
                        "peak_MB": memory_MB(process.pid, "VmHWM")}
            process.terminate()
        return figures


def read_MB(process):
    """What it has read by system calls, from files in memory as well."""
    return int(pathlib.Path(f"/proc/{process}/io").read_text().split()[1]) * 1e-6


def main():
    binaries = pathlib.Path(sys.argv[1]).resolve()
    assets = int(sys.argv[2]) if len(sys.argv) > 2 else 50
    years = int(sys.argv[3]) if len(sys.argv) > 3 else 20
    services = sys.argv[4:] or SERVICES
    print(f"start-up on {assets} assets x {years} years of monthly tests; {load()}")
    met = True
    with tempfile.TemporaryDirectory(prefix="sealwatch-start-up-") as folder:
        folder = pathlib.Path(folder)
        record(binaries, folder)
        config = configuration(folder / "config", assets)
        for service in services:
            state = folder / f"state-{service}"
            state.mkdir()
            journal = state / f"{service}.db"
            rows = subprocess.run([str(word) for word in (binaries / "perf/long_history", folder / "one" / journal.name,
                                                          journal, ASSET, assets, years)],
                                  check=True, capture_output=True, text=True).stdout.split()
            size_GB = 1e-9 * journal.stat().st_size
            took = start(binaries, service, config, state)
            print(f"  {service:22} {rows[0]} outputs, {rows[1]} inputs ({size_GB:.2f} GB): ready in {took['ready_s']:.1f} s "
                  f"({took['ready_cpu_s']:.1f} s of a processor, {took['read_MB']:.0f} MB read) with {took['ready_MB']:.0f} MB; "
                  f"recalled after {took['recalled_s']:.0f} s ({took['recalled_cpu_s']:.1f} s of a processor) with {took['all_MB']:.0f} MB; peak {took['peak_MB']:.0f} MB",
                  flush=True)
            met = met and took["ready_s"] < GOAL_S
            shutil.rmtree(state)
    print(f"  goal: ready in {GOAL_S:.0f} s: {'met' if met else 'MISSED'}")
    sys.exit(not met)


if __name__ == "__main__":
    main()
