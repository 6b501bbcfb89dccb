#!/usr/bin/env python3
"""No file that a command is given makes it wait, fill the memory or fail within: it names the file and the rule. The
largest recording that there may be is taken, in as little memory; one more row is too many.

hostile_files.py SOURCE_DIR BIN_DIR FOLDER
"""
import os
import resource
import shutil
import signal
import socket
import struct
import subprocess
import sys
import time
import zlib

SOURCE, BIN, FOLDER = sys.argv[1:4]
ASSET = f"{SOURCE}/config/assets/xt03-mv2.yaml"
MOST_SECONDS = 20.0  # on a machine with other work; alone each takes a fraction of one
MOST_MB = 512


def path(name):
    return os.path.join(FOLDER, name)


def write(name, content):
    with open(path(name), "wb") as file:
        file.write(content if isinstance(content, bytes) else content.encode())
    return path(name)


def run(*arguments, seconds=MOST_SECONDS):
    """Exit status (None: it had to be killed), greatest memory in MB, and what was printed."""
    output = open(path("output"), "wb+")
    child = subprocess.Popen([f"{BIN}/sealwatch", *arguments], stdin=subprocess.DEVNULL, stdout=output,
                             stderr=subprocess.STDOUT, cwd=FOLDER, start_new_session=True)
    end = time.monotonic() + seconds
    killed = False
    while True:
        pid, status, usage = os.wait4(child.pid, os.WNOHANG)
        if pid:
            break
        if time.monotonic() > end and not killed:
            killed = True
            os.killpg(child.pid, signal.SIGKILL)
        time.sleep(0.01)
    child.returncode = 0
    output.seek(0)
    text = output.read(100_000).decode(errors="replace")
    return None if killed else os.waitstatus_to_exitcode(status), usage.ru_maxrss / 1024, text


# Each makes what is no file of a person under a name.
def fifo(name):
    os.mkfifo(path(name))


def device(name):
    os.symlink("/dev/zero", path(name))


def directory(name):
    os.mkdir(path(name))


def listener(name):
    with socket.socket(socket.AF_UNIX) as one:
        one.bind(path(name))


def sparse(name):
    with open(path(name), "wb") as file:
        file.truncate(100 << 30)


KINDS = [fifo, device, directory, listener, sparse]

# Commands, with @SUFFIX where the file stands.
COMMANDS = """
fit --asset ASSET @.csv
fit --asset ASSET @.mat
fit --asset ASSET @.h5
fit --asset @.yaml RECORDING
fit --asset ASSET --map @.yaml RECORDING
validate --asset ASSET @.csv --out out
validate --simulated @.csv RECORDING
validate --simulated RECORDING @.h5
explain --asset ASSET --fit @.csv --out out
explain --asset ASSET --fit RECORDING --holdout @.mat --out out
simulate --asset ASSET --input @.csv --out out
forecast --history @.csv
forecast --history HISTORY --asset @.yaml
forecast --history HISTORY --config @.yaml
fleet fit @.csv HISTORY
plant import @.fmu --out plant.yaml
plant check @.yaml
plant show @.yaml
asset new --yes --from @.csv --out new.yaml
asset new --yes --from @.mat --out new.yaml
asset new --yes --from @.h5 --out new.yaml
asset new --yes --from RECORDING --model @.yaml --out new.yaml
replay --offline --config CONFIG @.csv
replay --offline --config @.yaml RECORDING
config check --config @.yaml
status --seconds 0.5 --config @.yaml
up --config @.yaml
verify rul --asset @.yaml --out out
""".strip().splitlines()


def element(kind, content):
    return struct.pack("<II", kind, len(content)) + content + b"\0" * (-len(content) % 8)


def array(name, count, content):
    body = (element(6, struct.pack("<II", 6, 0)) + element(5, struct.pack("<2i", count, 1)) +
            element(1, name.encode()) + element(9, content))
    return struct.pack("<II", 14, len(body)) + body


def matlab(*parts):
    return b"MATLAB 5.0 MAT-file".ljust(116) + b"\0" * 8 + b"\0\1IM" + b"".join(parts)


def bomb():
    """A vector of three numbers with two gigabytes of zeros behind it, in two megabytes."""
    deflater = zlib.compressobj(9)
    content = deflater.compress(array("position", 3, b"\0" * 24))
    for _ in range(2048):
        content += deflater.compress(b"\0" * (1 << 20))
    content += deflater.flush()
    return matlab(struct.pack("<II", 15, len(content)) + content)


def growing_yaml(count):
    return "".join(f"k{k}: &a{k} 1\n" for k in range(count))


failures = []


def expect(arguments, words, what):
    status, memory, text = run(*arguments)
    fault = ""
    if status != 2:
        fault = "does not end" if status is None else f"ends with {status}"
    elif memory > MOST_MB:
        fault = f"takes {memory:.0f} MB"
    elif not all(word in text for word in words):
        fault = f"does not say {words}"
    if fault:
        failures.append(f"{what}: {fault}: {text[:300]}")


def files_that_are_none():
    for kind in KINDS:
        for command in COMMANDS:
            name = "hostile" + command.split("@")[1].split()[0]
            for old in (name, "hostile.yaml"):  # which would be the sidecar of a recording
                if os.path.lexists(path(old)):
                    os.rmdir(path(old)) if os.path.isdir(path(old)) else os.remove(path(old))
            kind(name)
            if kind is directory and name.endswith(".yaml") and "--config" in command:
                continue  # the configuration's folder: it may be one
            words = {"ASSET": ASSET, "RECORDING": path("good.csv"), "HISTORY": path("history.csv"),
                     "CONFIG": f"{SOURCE}/config"}
            arguments = [words.get(word, path(name) if word.startswith("@") else word) for word in command.split()]
            expect(arguments, [name], f"{kind.__name__}: {command}")
    for page in (["validate", "--simulated", path("good.csv"), path("good.csv"), "--page", path("page.html")],
                 ["forecast", "--history", path("history.csv"), "--page", path("page.html")]):
        if not os.path.lexists(path("page.html")):
            fifo("page.html")
        expect(page, ["page.html", "nobody reads"], " ".join(page[:1]) + " --page a pipe")


def contents():
    write("bomb.mat", bomb())
    write("many.mat", matlab(array("v", 1, b"\0" * 8) * 100_000))
    for command in (["fit", "--asset", ASSET], ["asset", "new", "--yes", "--out", path("new.yaml"), "--from"]):
        expect([*command, path("bomb.mat")], ["bomb.mat", "unpacks to more than"], "a MAT file that inflates")
        expect([*command, path("many.mat")], ["many.mat", "variables"], "a MAT file of many variables")
    for name, content in {"keys.yaml": growing_yaml(20_000), "flow.yaml": "x: [" + "{a}," * 80_000 + "]\n",
                          "braces.yaml": "x: {" + "{}," * 100_000 + "}\n", "deep.yaml": "x: " + "[" * 100_000,
                          "long.yaml": "x: 1\n" * 200_000}.items():
        write(name, content)
        for command in (["fit", path("good.csv"), "--asset"], ["plant", "check"], ["config", "check", "--config"]):
            expect([*command, path(name)], [name], " ".join(command[:2]) + " " + name)
    write("wide.csv", ",".join(f"c{k}" for k in range(100_000)) + "\n")
    expect(["forecast", "--history", path("wide.csv")], ["wide.csv", "is not a history"], "a history of many columns")


def largest_recording():
    """Of two million numbers (include/sealwatch/core/test_limits.hpp), and of a row more."""
    channels = ["time[s]", "pressure_a[Pa]", "pressure_b[Pa]", "flow[m3/s]", "position[m]"]
    head = ",".join(channels) + "\n"
    count = 2_000_000 // len(channels)
    rows = [f"{0.0002 * k:.4f},{2e6 + k % 997},{1e6 + k % 991},{1e-5 * (k % 7):.5f},{0.06 - 1e-7 * k:.7f}\n" for k in range(count + 1)]
    write("most.csv", head + "".join(rows[:count]))
    write("more.csv", head + "".join(rows))
    for command in (["validate", "--simulated", path("most.csv")], ["fit", "--asset", ASSET]):
        status, memory, text = run(*command, path("most.csv"), seconds=150.0)
        what = f"{command[0]} of the largest recording"
        if status not in (0, 1):
            failures.append(f"{what}: ends with {status}: {text[:300]}")
        if memory > MOST_MB:
            failures.append(f"{what}: takes {memory:.0f} MB")
    expect(["fit", "--asset", ASSET, path("more.csv")], ["more.csv", "numbers"], "a recording of a row too many")


def main():
    shutil.rmtree(FOLDER, ignore_errors=True)
    os.makedirs(FOLDER)
    write("good.csv", "time[s],position[m]\n" + "".join(f"{0.02 * k:.2f},{0.001 * k:.3f}\n" for k in range(200)))
    write("history.csv", "time[iso8601],theta[1],theta_std[1]\n" +
          "".join(f"20{20 + k // 12}-{k % 12 + 1:02d}-10T00:00:00Z,{0.95 - 0.005 * k:.4f},0.01\n" for k in range(24)))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    files_that_are_none()
    contents()
    largest_recording()
    shutil.rmtree(FOLDER, ignore_errors=True)
    print("\n".join(failures) or "every command refuses by name")
    sys.exit(1 if failures else 0)


main()
