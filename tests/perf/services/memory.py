#!/usr/bin/python3
"""How much memory the largest permitted test takes (include/sealwatch/core/test_limits.hpp): each command that reads
recordings, and each of the six services, by the most that was resident. Shapes of two million numbers:
  fast    half a minute at 7 kHz, nine channels
  long    the same rows over seven days
  sparse  bursts of three rows: the uniform window has nearly ten rows for each
  narrow  the smallest useful set of channels
Usage: memory.py BIN_DIRECTORY [SHAPE...]; ends with 1 where a process took more than the limit.
"""
import multiprocessing
import os
import pathlib
import subprocess
import sys
import tempfile
import time

from services import DOMAIN, SOURCE, Services, load, memory_MB

LIMIT_MB = 512.0
NUMBERS = 2_000_000
SHAPES = ["fast", "long", "sparse", "narrow"]
NARROW = ["time[s]", "pressure_a[Pa]", "pressure_b[Pa]", "flow[m3/s]", "position[m]", "velocity[m/s]"]
WEEK_S = 6.9 * 86400.0
ASSET = SOURCE / "config/assets/xt03-mv2.yaml"


def base(sealwatch, folder):
    """A partial stroke test at the bench's highest rate."""
    subprocess.run([sealwatch, "simulate", "--asset", ASSET, "--rate", "5000", "--out", folder], check=True, stdout=subprocess.DEVNULL)
    file = next(folder.glob("*.csv"))
    lines = file.read_text().splitlines()
    return file, lines[0].split(","), [line.split(",") for line in lines[1:]]


def write(shape, file, head, rows, folder):
    """Its rows, drawn out to as many numbers as a test may have."""
    columns = [head.index(name) for name in NARROW] if shape == "narrow" else list(range(len(head)))
    count = NUMBERS // len(columns)
    duration_s = WEEK_S if shape == "long" else float(rows[-1][0])
    places = [k // 3 * 29 + k % 3 if shape == "sparse" else k for k in range(count)]
    out = folder / f"{shape}.csv"
    with out.open("w") as csv:
        csv.write(",".join(head[c] for c in columns) + "\n")
        for place in places:
            share = place / places[-1]
            row = rows[int(share * (len(rows) - 1))]
            csv.write(",".join([f"{share * duration_s:.9f}", *(row[c] for c in columns[1:])]) + "\n")
    side = file.with_suffix(".yaml").read_text().replace(file.stem, shape)
    kept = {head[c].split("[")[0] for c in columns}
    unknown = {name.split("[")[0] for name in head} - kept
    out.with_suffix(".yaml").write_text("".join(f"{line}\n" for line in side.splitlines()
                                                if line.split(":")[0].strip() not in unknown))
    return out


def make(shape, sealwatch, folder):
    return write(shape, *base(sealwatch, folder / f"base-{shape}"), folder)


def peak_MB(command, log):
    """Of the process and those that it waited for; processor time, exit status."""
    with log.open("w") as out:
        process = subprocess.Popen([str(word) for word in command], stdout=out, stderr=out, cwd=SOURCE)
        _, status, usage = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    return usage.ru_maxrss * 1024e-6, usage.ru_utime, process.returncode


def commands(sealwatch, recording, folder):
    out = folder / "out"
    return {
        "replay --offline": [sealwatch, "replay", "--offline", "--quiet", recording],
        "fit": [sealwatch, "fit", "--asset", ASSET, recording],
        "explain": [sealwatch, "explain", "--asset", ASSET, "--fit", recording, "--out", out, "--time-limit", "300"],
        "validate": [sealwatch, "validate", "--asset", ASSET, "--out", out, recording],
        "validate --simulated": [sealwatch, "validate", "--simulated", recording, recording],
        "asset new": [sealwatch, "asset", "new", "--from", recording, "--out", folder / "new.yaml"],
        "simulate --input": [sealwatch, "simulate", "--asset", ASSET, "--input", recording, "--out", out],
    }


def configuration(folder):
    """The repository's, in a domain of its own."""
    config = folder / "config"
    if not config.exists():
        config.mkdir()
        (config / "assets").symlink_to(SOURCE / "config/assets")
        text = (SOURCE / "config/sealwatch.yaml").read_text()
        (config / "sealwatch.yaml").write_text(text.replace("domain: 0 ", f"domain: {DOMAIN} "))
    return config


def of_services(binaries, recording, folder):
    """Each service's peak, from its start on, of a test that is replayed; and what it was before."""
    with Services(binaries, configuration(folder)) as services:
        time.sleep(3.0)
        idle = {name: memory_MB(process.pid, "VmRSS") for name, process in services.processes.items()}
        replay = services.start([binaries / "sealwatch", "replay", "--config", folder / "config", "--quiet", recording], stdout=subprocess.DEVNULL,
                                stderr=subprocess.DEVNULL, cwd=SOURCE)
        _, _, usage = os.wait4(replay.pid, 0)
        peaks = {name: memory_MB(process.pid, "VmHWM") for name, process in services.processes.items()}
    return idle, {"replay": usage.ru_maxrss * 1024e-6, **peaks}


def main():
    binaries = pathlib.Path(sys.argv[1]).resolve()
    print(f"memory of the largest test; {load()}")
    worst = 0.0
    with tempfile.TemporaryDirectory(prefix="sealwatch-memory-") as folder:
        folder = pathlib.Path(folder)
        for shape in sys.argv[2:] or SHAPES:
            # In a process of its own: what this one once held would count as the programs' that it starts.
            with multiprocessing.Pool(1) as pool:
                recording = pool.apply(make, (shape, binaries / "sealwatch", folder))
            for name, command in commands(binaries / "sealwatch", recording, folder).items():
                peak, user_s, status = peak_MB(command, folder / "log")
                print(f"  {shape:7} {name:22} {peak:6.0f} MB  {user_s:6.1f} s  exit {status}", flush=True)
                worst = max(worst, peak)
            idle, peaks = of_services(binaries, recording, folder)
            for name, peak in peaks.items():
                print(f"  {shape:7} {name:22} {peak:6.0f} MB  (idle {idle.get(name, 0.0):.0f} MB)", flush=True)
            worst = max(worst, *peaks.values())
    print(f"  at most {LIMIT_MB:.0f} MB: {'met' if worst <= LIMIT_MB else 'MISSED'} ({worst:.0f} MB)")
    sys.exit(worst > LIMIT_MB)


if __name__ == "__main__":
    main()
