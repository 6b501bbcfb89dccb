#!/usr/bin/python3
"""How long services take to be ready on the journals of a long history, and how much memory they then have. A few months of
one actuator are recorded and concluded; their rows, with other names and dates, make the history of many. The dates are
those of monthly tests; samples older than the last month are dropped, as retention does.
Usage: start_up.py BIN_DIRECTORY [ASSETS [YEARS [SERVICE...]]]
"""
import os
import pathlib
import re
import shutil
import socket
import sqlite3
import subprocess
import sys
import tempfile
import time

from services import DOMAIN, SOURCE, cpu_s, load, memory_MB, uri

GOAL_S, MONTHS, ASSET = 20.0, 12, "XT03-MV2"
SERVICES = ["state_detection", "health_assessment", "prognostic_assessment", "advisory_generation", "data_manipulation",
            "data_acquisition"]
SAMPLES = re.compile(r'"samples":\{.*?\}(?=,"[a-z_]+":|\}$)', re.DOTALL)
TIME = re.compile(r'("event_time_ns":)(\d+)')
MONTH_NS = 2629746 * 10**9


def record(binaries, folder):
    """The journals of a year of one actuator."""
    environment = dict(os.environ, CYCLONEDDS_URI=uri(f"start-up-{os.getpid()}"))
    run = lambda *words: subprocess.run([str(w) for w in words], env=environment, check=True, stdout=subprocess.DEVNULL)
    run(binaries / "sealwatch", "simulate", "--asset", SOURCE / "config/assets/xt03-mv2.yaml", "--months", MONTHS, "--rate", 20,
        "--out", folder / "life")
    run(binaries / "sealwatch", "replay", "--quiet", "--with-services", "--config", SOURCE / "config", "--state", folder / "one",
        *sorted((folder / "life").glob("*.csv")))


def later(payload, months):
    return TIME.sub(lambda found: found[1] + str(int(found[2]) + months * MONTH_NS), payload)


def multiply(one, many, assets, years):
    """Rows of `assets` actuators over so many years in `many`, made of those in `one`; how many outputs there are."""
    shutil.copy(one, many)
    journal = sqlite3.connect(many, isolation_level=None)
    for setting in ("synchronous = OFF", "journal_mode = OFF", "cache_size = -1000000"):
        journal.execute(f"PRAGMA {setting}")
    rows = journal.execute("SELECT topic, message_id, pst_id, published, payload FROM outputs WHERE pst_id <> ''"
                           " ORDER BY ordinal").fetchall()
    rows = [(topic, name, pst, published, SAMPLES.sub('"samples":{}', payload)) for topic, name, pst, published, payload in rows]
    ordinal, = journal.execute("SELECT max(ordinal) FROM outputs").fetchone()
    sequences = dict(journal.execute("SELECT topic, max(sequence) FROM outputs GROUP BY topic"))
    journal.execute("BEGIN")
    for year in range(years):
        moved = [(topic, name, pst, published, later(payload, MONTHS * year)) for topic, name, pst, published, payload in rows]
        for asset in range(assets):
            named = lambda text: text.replace(ASSET, f"A{asset:04}-{year:02}"[:5]) + f"-{year:02}"
            batch = []
            for topic, name, pst, published, payload in moved:
                ordinal += 1
                sequences[topic] += 1
                new_pst = named(pst)
                content = payload.replace(pst, "\0").replace(ASSET, f"A{asset:04}").replace("\0", new_pst)
                batch.append((ordinal, topic, sequences[topic], name.replace(pst, new_pst), f"A{asset:04}", new_pst, published, content))
            journal.executemany("INSERT INTO outputs(ordinal, topic, sequence, message_id, asset_id, pst_id, published, payload)"
                                " VALUES(?, ?, ?, ?, ?, ?, ?, ?)", batch)
    journal.execute("COMMIT")
    journal.execute("PRAGMA journal_mode = WAL")
    return ordinal


def start(binaries, service, state):
    """Seconds until it says that it is ready (and of a processor), until it has recalled all, and its own memory then."""
    with tempfile.TemporaryDirectory() as folder:
        listener = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
        listener.bind(folder + "/notify")
        listener.settimeout(1200)
        environment = dict(os.environ, NOTIFY_SOCKET=folder + "/notify", CYCLONEDDS_URI=uri(f"start-up-{os.getpid()}-{service}"))
        begin = time.monotonic()
        with subprocess.Popen([str(binaries / f"sealwatch-{service.replace('_', '-')}"), "--config", str(SOURCE / "config"), "--state",
                               str(state), "--domain", str(DOMAIN)], env=environment, stderr=subprocess.DEVNULL) as process:
            while b"READY=1" not in listener.recv(4096):
                pass
            ready_s, ready_MB, ready_cpu_s = time.monotonic() - begin, memory_MB(process.pid, "RssAnon"), cpu_s(process.pid)
            recalled_s = ready_s
            while time.monotonic() - begin < 900:
                text = "".join(file.read_text() for file in (state / "log").glob(f"*{service}*"))
                if "is recalled" in text or "restored_outputs" in text:
                    recalled_s = time.monotonic() - begin
                    break
                time.sleep(0.2)
            all_MB = memory_MB(process.pid, "RssAnon")
            process.terminate()
        return ready_s, ready_cpu_s, ready_MB, recalled_s, all_MB


def main():
    binaries = pathlib.Path(sys.argv[1]).resolve()
    assets = int(sys.argv[2]) if len(sys.argv) > 2 else 50
    years = int(sys.argv[3]) if len(sys.argv) > 3 else 20
    services = sys.argv[4:] or SERVICES[:4]
    print(f"start-up on {assets} assets x {years} years of monthly tests; {load()}")
    met = True
    with tempfile.TemporaryDirectory(prefix="sealwatch-start-up-") as folder:
        folder = pathlib.Path(folder)
        record(binaries, folder)
        for service in services:
            state = folder / f"state-{service}"
            state.mkdir()
            journal = next(path for path in (folder / "one").glob("*.db") if service in path.stem.replace("-", "_"))
            outputs = multiply(journal, state / journal.name, assets, years)
            size_GB = 1e-9 * (state / journal.name).stat().st_size
            ready_s, ready_cpu_s, ready_MB, recalled_s, all_MB = start(binaries, service, state)
            print(f"  {service:22} {outputs:8} outputs ({size_GB:.2f} GB): ready in {ready_s:.1f} s ({ready_cpu_s:.1f} s of a processor) with {ready_MB:.0f} MB; "
                  f"all recalled after {recalled_s:.0f} s with {all_MB:.0f} MB", flush=True)
            met = met and ready_s < GOAL_S
            shutil.rmtree(state)
    print(f"  goal: ready in {GOAL_S:.0f} s: {'met' if met else 'MISSED'}")
    sys.exit(not met)


if __name__ == "__main__":
    main()
