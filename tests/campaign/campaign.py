#!/usr/bin/python3
"""Faults under which the six real services must end with the results of an undisturbed run: killed at random moments,
bits turned in every table of their journals, a full disk, a disk that cannot be written, clocks that are set, a bad
network between two hosts; and the floods, the poison, the tests that take too long and the years under which they must
stay as they are. One line for each trial, with its seed: the same seed makes the same choices, though not the same moments.
Usage: campaign.py BIN_DIRECTORY [kills|bits|damages|full_disk|read_only|clock_steps|two_hosts|flood|poison|overdue|leaks|years|history|all] [--seed N]
           [--kills N] [--bits N] [--damages N] [--tests N] [--steps N] [--seconds N] [--assets N] [--live N] [--floods NAMES]
"""
import argparse
import contextlib
import ctypes
import fcntl
import heapq
import json
import os
import pathlib
import random
import re
import resource
import select
import shutil
import signal
import socket
import sqlite3
import struct
import subprocess
import sys
import tempfile
import threading
import time

SOURCE = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(SOURCE / "tests/perf/services"))
from services import cpu_s, memory_MB, quantile  # noqa: E402  (what the measurements of speed use)

SERVICES = ["data-acquisition", "data-manipulation", "state-detection", "health-assessment", "prognostic-assessment",
            "advisory-generation"]
DOMAIN = 96
PATIENCE_S = float(os.environ.get("CAMPAIGN_PATIENCE_S", 240.0))  # longer where the machine has much else to do
TRIALS = ["kills", "bits", "damages", "full_disk", "read_only", "clock_steps", "two_hosts", "flood", "poison", "overdue",
          "leaks", "years", "history", "packed"]
LIVE_DOMAIN = 97  # of tests/perf/services/live_latency.cpp
MOST_STATUS_KB = 200.0      # what `status --json` says of six services, whatever strangers sent
MOST_GROWTH_MB = 100.0      # of a service under a flood: its queues and inboxes, all of them bounded
MOST_MORE_PAGES = 100       # beside twice as many, for a statement of a start on a longer history
LONGEST_START_S = 20.0      # until all services have their past, after whatever history
# What is done for so long and no longer: assets are recalled and their last word published, indexes looked at.
BOUNDED = ("packed_outputs", "FROM outputs WHERE asset_id =", "FROM outputs WHERE ordinal",
           "FROM outputs WHERE sequence", "NOT INDEXED")
FINDING = re.compile(r"\w+Sanitizer: .*|runtime error: .*")  # of a build with sanitizers, whatever its exit status
TABLES = {"inputs": ["message_id", "payload", "consumed", "pst_id"], "outputs": ["payload", "asset_id", "checksum"],
          "positions": ["sequence", "writer_id"], "quarantine": ["reason"], "acts": ["who", "hash"],
          "meta": ["value"], "alarms": ["payload"], "packed_outputs": ["body", "ends"]}


class Failed(Exception):
    pass


def used_pages(file):
    """Of a closed journal: those that SQLite reads, and their size."""
    with sqlite3.connect(file) as journal:
        pages = [row[0] for row in journal.execute("SELECT pageno FROM dbstat ORDER BY pageno")]
        return pages, journal.execute("PRAGMA page_size").fetchone()[0]


def zero_page(campaign, file):
    pages, size = used_pages(file)
    with open(file, "r+b") as content:
        content.seek((campaign.random.choice(pages) - 1) * size)
        content.write(bytes(size))


def garbage_in(file, share):
    size = file.stat().st_size if file.exists() else 5000
    with open(file, "r+b" if file.exists() else "wb") as content:
        content.seek(int(size * share))
        content.write(os.urandom(size - int(size * share)))


def log_of(file):
    return file.with_name(file.name + "-wal")


def from_another(campaign, file):
    shutil.copy(file.parent / database(campaign.random.choice([s for s in SERVICES if database(s) != file.name])), file)


def remove_all_of(_, file):
    """As of a service that never ran, with its locks and marks: its neighbours alone remember it."""
    for one in file.parent.glob(file.stem + ".*"):
        one.unlink()


def copy_over(source, file):
    shutil.copy(source / file.name, file)


# What is done to a journal that its service has closed, or left when it was killed.
CLOSED = {"zeroed page": zero_page, "cut": lambda c, file: os.truncate(file, int(file.stat().st_size * c.random.uniform(0.2, 0.9))),
          "removed": lambda c, file: file.unlink(), "removed with all beside it": remove_all_of, "emptied": lambda c, file: os.truncate(file, 0),
          "another service's": from_another, "another site's": lambda c, file: copy_over(c.other_site, file),
          "older backup": lambda c, file: copy_over(c.older, file)}
KILLED = {"log removed": lambda c, file: log_of(file).unlink(), "log's end spoilt": lambda c, file: garbage_in(log_of(file), 0.6)}
# What SQLite never reads.
HARMLESS = {"garbage behind the last page": lambda c, file: file.write_bytes(file.read_bytes() + os.urandom(5000)),
            "garbage as a log": lambda c, file: garbage_in(log_of(file), 0.0)}


def database(service):
    return service.replace("-", "_") + ".db"


class World:
    """A state directory with its services, in a discovery tag of their own."""
    count = 0

    def __init__(self, binaries, folder, state=None, interface="lo", prefixes=None, environment=None):
        World.count += 1
        self.prefixes = prefixes or {}  # before a service's command line, as of the host that it runs on
        self.binaries, self.folder = binaries, folder
        self.state = state or folder / f"state-{World.count}"
        self.state.mkdir(exist_ok=True)
        uri = ('<CycloneDDS><Domain Id="any"><General><Interfaces>'
               f'<NetworkInterface name="{interface}" multicast="true"/>'
               '</Interfaces></General><Discovery><LeaseDuration>2s</LeaseDuration>'
               f'<Tag>campaign-{os.getpid()}-{World.count}</Tag></Discovery></Domain></CycloneDDS>')
        self.environment = dict(os.environ, CYCLONEDDS_URI=uri, **(environment or {}))
        self.processes, self.most_bytes = {}, None

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.stop()

    def limit(self):
        """In a service: files no longer than that, as on a full disk."""
        if self.most_bytes:
            resource.setrlimit(resource.RLIMIT_FSIZE, (self.most_bytes, resource.RLIM_INFINITY))

    def start(self, service):
        log = open(self.folder / "services.log", "a")
        self.processes[service] = subprocess.Popen(
            [*self.prefixes.get(service, []), self.binaries / f"sealwatch-{service}", "--config", self.folder,
             "--state", self.state],
            env=self.environment, stdout=log, stderr=log, preexec_fn=self.limit)

    def start_all(self):
        for service in SERVICES:
            self.start(service)

    def wait_until_running(self):
        """Until the last service has said so in its heartbeat."""
        end = time.monotonic() + PATIENCE_S
        while self.run("status", "--json", "--seconds", "0.5").stdout.count('"state": "running"') < len(SERVICES):
            if time.monotonic() > end:
                raise Failed("the services do not start")

    def keep_up(self):
        """Starts again what has ended, as systemd does; which, and with what exit status."""
        ended = {name: process.returncode for name, process in self.processes.items() if process.poll() is not None}
        for name in ended:
            self.start(name)
        return ended

    def kill(self, service):
        self.processes[service].kill()
        self.processes[service].wait()
        self.start(service)

    def stop(self):
        for process in self.processes.values():
            process.send_signal(signal.SIGTERM)
        for process in self.processes.values():
            try:
                process.wait(20)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()
        self.processes = {}

    def command(self, *words):
        return [self.binaries / "sealwatch", *map(str, words), "--config", self.folder]

    def replay(self, files):
        # On a starved machine it may hear nothing for longer than it waits: that is no result.
        again = 'until "$@"; do tail -n 1 "$0" | grep -q "no heartbeat from\\|nothing has come for" || exit 1; done'
        log = self.folder / "replay.log"
        return subprocess.Popen([*self.prefixes.get("replay", []), "sh", "-c", again, log, *self.command("replay"),
                                 "--quiet", *map(str, files)],
                                env=self.environment, stdout=subprocess.DEVNULL, stderr=open(log, "a"))

    def run(self, *words):
        done = subprocess.run([*self.prefixes.get("replay", []), *self.command(*words)], env=self.environment,
                              capture_output=True, text=True)
        with open(self.folder / "replay.log", "a") as log:
            log.write(done.stderr)
        return done

    def says(self):
        """For whoever looks into a failure and has this text alone."""
        status = self.run("status", "--seconds", "3").stdout
        alive = [name for name, process in self.processes.items() if process.poll() is None]
        last = {name: (self.folder / f"{name}.log").read_text(errors="replace").splitlines()[-12:]
                for name in ("replay", "services") if (self.folder / f"{name}.log").exists()}
        return "\n".join([f"processes that run: {alive}", status, *(f"{name}: {line}" for name in last for line in last[name])])

    def sizes(self):
        """By service: own memory in MB, and open descriptors."""
        return {name: (memory_MB(process.pid, "RssAnon"), len(os.listdir(f"/proc/{process.pid}/fd")))
                for name, process in self.processes.items()}

    def results(self):
        """By service: every conclusion's id and exact text. The journals are closed, or only read."""
        results = {}
        for service in SERVICES:
            with sqlite3.connect(f"file:{self.state / database(service)}?mode=ro", uri=True, timeout=10) as journal:
                journal.text_factory = lambda text: text.decode(errors="backslashreplace")  # a bit may be turned in it
                results[service] = dict(journal.execute("SELECT message_id, payload FROM outputs"))
        return results


def replayed(world, files):
    """Plays recordings back through services that nobody disturbs, and waits for the last conclusion."""
    if world.replay(files).wait(PATIENCE_S) != 0:
        raise Failed("the replay did not end well")


def settle(world, expected, patience_s=60.0):
    """Waits until the results are those; what differs, else."""
    end = time.monotonic() + patience_s
    while True:
        difference = differences(expected, world.results())
        if not difference or time.monotonic() > end:
            return difference
        world.keep_up()
        time.sleep(0.3)


def set_aside(world):
    listed = json.loads(world.run("quarantine", "list", "--json", "--state", world.state).stdout)["messages"]
    return [message for message in listed if message["asset_id"]]  # a lost journal stands there too


def alarms_of(world, asset):
    status = json.loads(world.run("status", "--json", "--seconds", "1.5").stdout)
    return [alarm for alarm in status["alarms"] if alarm["asset_id"] == asset]


def concluded(world, service, topic, asset):
    with sqlite3.connect(f"file:{world.state / database(service)}?mode=ro", uri=True, timeout=10) as journal:
        return [row[0] for row in journal.execute("SELECT message_id FROM outputs WHERE topic = ? AND asset_id = ?", (topic, asset))]


def estimated(world, asset):
    return concluded(world, "prognostic-assessment", "leakage_estimate", asset)


def analysed(world, assets, tests):
    """Of those whose tests all have their health, which is when the analysis of the last begins: whether it is done."""
    return {asset: bool(concluded(world, "health-assessment", "model_discrepancy", asset)) for asset in assets
            if len(concluded(world, "health-assessment", "health_report", asset)) == tests}


def differences(expected, found):
    texts = []
    for service in SERVICES:
        missing = expected[service].keys() - found[service].keys()
        more = found[service].keys() - expected[service].keys()
        other = [one for one in expected[service].keys() & found[service].keys()
                 if expected[service][one] != found[service][one]]
        if missing or more or other:
            example = sorted([*missing, *more, *other])[0]
            texts.append(f"{service}: {len(missing)} missing, {len(more)} more, {len(other)} different ({example})")
    return "; ".join(texts)


def findings(folder):
    """What sanitizers said of any program, each kind once."""
    logs = [file.read_text(errors="replace") for name in ("services", "replay") for file in folder.rglob(f"{name}.log")]
    return sorted({finding for log in logs for finding in FINDING.findall(log)})


class Campaign:
    def __init__(self, arguments, folder):
        self.arguments, self.folder = arguments, folder
        self.binaries = pathlib.Path(arguments.binaries).resolve()
        self.random = random.Random(arguments.seed)
        text = (SOURCE / "config/sealwatch.yaml").read_text()
        alone = "\noperator_acts: {confirmed_by_second: false}\n"  # the campaign retracts and replaces by itself
        (folder / "sealwatch.yaml").write_text(text.replace("domain: 0 ", f"domain: {DOMAIN} ") + alone)
        (folder / "assets").symlink_to(SOURCE / "config/assets")
        subprocess.run([self.binaries / "sealwatch", "simulate", "--asset", SOURCE / "config/assets/xt03-mv2.yaml",
                        # In twenty years a seal that ages fails and ends the life.
                        *(["--ageing"] if arguments.trial != "years" else []), "--months", str(arguments.tests), "--rate", "50", "--seed", "7", "--out",
                        folder / "life"], check=True, stdout=subprocess.DEVNULL)
        self.files = sorted((folder / "life").glob("*.csv"))
        self.undisturbed, self.kept, self.kept_results = None, None, None

    def prepare(self):
        """The results of an undisturbed run, and its state after a retraction."""
        with World(self.binaries, self.folder) as world:
            world.start_all()
            world.wait_until_running()
            replayed(world, self.files)
            self.undisturbed = world.results()
            test = sorted(self.undisturbed["state-detection"])[0].split("/")[1]
            retracted = world.run("retract", "XT03-MV2", "--test", test, "--by", "campaign", "--reason", "a trial")
            time.sleep(2.0)  # all layers have concluded anew
            world.stop()
            if retracted.returncode != 0:
                raise Failed(f"the retraction was not taken: {retracted.stderr}")
            self.kept, self.kept_results = world.state, world.results()
        return len(self.undisturbed["advisory-generation"])

    def kills(self):
        done, rounds, victims = 0, 0, dict.fromkeys(SERVICES, 0)
        while done < self.arguments.kills:
            rounds += 1
            with World(self.binaries, self.folder) as world:
                world.start_all()
                world.wait_until_running()
                replay = world.replay(self.files)
                end = time.monotonic() + PATIENCE_S
                while replay.poll() is None and time.monotonic() < end:
                    # A service that ends five times while it works on one test sets it aside, whoever ended it: each
                    # lives for some seconds on the average.
                    time.sleep(self.random.uniform(0.1, 1.1))
                    world.keep_up()
                    if done < self.arguments.kills:
                        victim = self.random.choice(SERVICES)
                        world.kill(victim)
                        done, victims[victim] = done + 1, victims[victim] + 1
                if replay.poll() is None:
                    said = world.says()
                    replay.kill()
                    raise Failed(f"after {done} kills the replay did not end in {PATIENCE_S:.0f} s; {said}")
                if difference := settle(world, self.undisturbed):
                    raise Failed(f"after {done} kills: {difference}")
                world.stop()
                shutil.rmtree(world.state)
        return f"{done} kills in {rounds} replays ({', '.join(map(str, victims.values()))} by layer): results identical"

    def turn_bit(self, state):
        """In one field of one row, by the library, so that its indexes agree; the place of it."""
        while True:
            service, table = self.random.choice(SERVICES), self.random.choice(list(TABLES))
            field = self.random.choice(TABLES[table])
            with sqlite3.connect(state / database(service)) as journal:
                journal.text_factory = bytes
                for change in ("UPDATE", "DELETE"):
                    journal.execute(f"DROP TRIGGER IF EXISTS acts_no_{change}")
                row = journal.execute(f"SELECT rowid, {field} FROM {table} WHERE {field} IS NOT NULL AND {field} <> ''"
                                      " ORDER BY random() LIMIT 1").fetchone()
                if row is None:
                    continue
                if isinstance(row[1], int):
                    value = row[1] ^ (1 << self.random.randrange(2 if field == "consumed" else 12))
                else:
                    content = bytearray(row[1])
                    content[self.random.randrange(len(content))] ^= 1 << self.random.randrange(7)
                    value = bytes(content)
                try:
                    journal.execute(f"UPDATE {table} SET {field} = CASE WHEN typeof({field}) = 'text' THEN"
                                    " CAST(? AS TEXT) ELSE ? END WHERE rowid = ?", (value, value, row[0]))
                except sqlite3.IntegrityError:
                    continue
                return f"{service}, {table}.{field}"

    def flip_page(self, state):
        """Anywhere in a file, its header, pages and indexes included."""
        service = self.random.choice(SERVICES)
        with sqlite3.connect(state / database(service)) as journal:
            journal.execute("PRAGMA wal_checkpoint(TRUNCATE)")
        file = state / database(service)
        place = self.random.randrange(file.stat().st_size)
        with open(file, "r+b") as content:
            content.seek(place)
            byte = content.read(1)[0] ^ (1 << self.random.randrange(8))
            content.seek(place)
            content.write(bytes([byte]))
        return f"{service}, byte {place}"

    def bits(self):
        identical, told, silent = 0, 0, []
        for number in range(self.arguments.bits):
            state = self.folder / f"turned-{number}"
            shutil.copytree(self.kept, state)
            place = self.flip_page(state) if number % 3 == 2 else self.turn_bit(state)
            with World(self.binaries, self.folder, state) as world:
                world.start_all()
                time.sleep(4.0)  # alive long enough to have read its past
                ended = world.keep_up()
                difference = settle(world, self.kept_results, 8.0)
                again = world.keep_up()
                status = world.run("status", "--json").stdout
                audit = world.run("audit", "--state", state)
                if again:
                    raise Failed(f"a bit in {place}: {again} does not stay up (before: {ended})")
                if not difference:
                    identical += 1
                elif "damaged" in status or audit.returncode != 0:
                    told += 1
                else:
                    silent.append(f"{place}: {difference}")
                world.stop()
            shutil.rmtree(state)
        if silent:
            raise Failed(f"{len(silent)} of {self.arguments.bits} bits changed results and nobody said so: {silent[0]}")
        return (f"{self.arguments.bits} bits, each in a copy of six journals: every service starts; results identical "
                f"{identical} times, else told as an alarm ({told})")

    def make_bases(self):
        """States to be damaged: of services that were stopped, or killed; an older backup, and another site's journals."""
        half = self.files[:len(self.files) // 2]
        for name, played in (("other_site", self.files[-1:]), ("closed", self.files), ("killed", self.files)):
            with World(self.binaries, self.folder) as world:
                world.start_all()
                world.wait_until_running()
                if name == "closed":
                    self.older = self.folder / "older"
                    replayed(world, half)
                    world.run("backup", "--state", world.state, "--to", self.older)
                replayed(world, played)
                time.sleep(1.5)  # what was heard is known
                if name == "killed":
                    for process in world.processes.values():
                        process.kill()
                        process.wait()
                world.stop()
                setattr(self, name, world.state)

    def damaged(self, base, service, damage):
        """What differs, and what is told, once a journal of that state was damaged and its service started."""
        state = self.folder / f"damaged-{World.count}"
        shutil.copytree(base, state)
        damage(self, state / database(service))
        with World(self.binaries, self.folder, state) as world:
            world.start_all()
            end = time.monotonic() + 4.0
            while time.monotonic() < end:  # as systemd does
                world.keep_up()
                time.sleep(0.3)
            difference = settle(world, self.undisturbed, 8.0)
            world.run("status", "--seconds", "1.5")
            if ended := world.keep_up():
                raise Failed(f"does not stay up: {ended}")
            told = [alarm["text"] for alarm in json.loads(world.run("status", "--json", "--seconds", "1.5").stdout)["alarms"]
                    if alarm["kind"] in ("set_aside", "no_heartbeat")]
        shutil.rmtree(state)
        return difference, told

    def damages(self):
        """Whole files and pages, not bits: noticed, told, and made again; what SQLite never reads changes nothing."""
        self.make_bases()
        cases = [(self.closed, service, name, damage, name in HARMLESS) for service in SERVICES
                 for name, damage in (CLOSED | HARMLESS).items()]
        # Of the last service's conclusions no neighbour knows how far they went.
        cases += [(self.killed, service, name, damage, False) for service in SERVICES for name, damage in KILLED.items()
                  if service != SERVICES[-1] or name == "log removed"]
        if self.arguments.damages:
            cases = self.random.sample(cases, self.arguments.damages)
        for base, service, name, damage, is_harmless in cases:
            try:
                difference, told = self.damaged(base, service, damage)
            except Failed as failure:
                raise Failed(f"{service}, {name}: {failure}") from None
            lost = service == SERVICES[0] and re.fullmatch(r"data-acquisition: \d+ missing, 0 more, 0 different \(.*\)", difference)
            if is_harmless and (difference or told):
                raise Failed(f"{service}, {name}: {difference or told}")
            if not is_harmless and (not told or (difference and not lost)):
                raise Failed(f"{service}, {name}: {difference or 'identical'}, told: {told}")
            if lost and not any("samples" in one or "damaged" in one or "in the place" in one for one in told):
                raise Failed(f"{service}, {name}: samples are lost, told: {told}")
        self.check_all_removed()
        return (f"{len(cases)} damages, and all journals removed at once: every service starts, each told as an alarm; results"
                " identical, or samples named as lost")

    def check_all_removed(self):
        """With their logs and locks: no neighbour knows of a journal before its own, and each service tells of its own."""
        state = self.folder / "all-removed"
        shutil.copytree(self.closed, state)
        for file in state.glob("*.db*"):
            file.unlink()
        with World(self.binaries, self.folder, state) as world:
            world.start_all()
            world.wait_until_running()
            told = {alarm["subject"]: alarm["text"] for alarm in json.loads(world.run("status", "--json", "--seconds", "1.5").stdout)["alarms"]
                    if alarm["kind"] == "set_aside"}
        silent = [service for service in SERVICES if "removed" not in told.get(f"journal/{service.replace('-', '_')}", "")]
        if silent:
            raise Failed(f"all journals removed: {silent} start empty and do not tell; told: {told}")

    def full_disk(self):
        with World(self.binaries, self.folder) as world:
            largest = max((self.kept / database(service)).stat().st_size for service in SERVICES)
            world.most_bytes = largest // 3
            world.start_all()
            replay = world.replay(self.files)
            gave_up, end = {}, time.monotonic() + 15.0
            while time.monotonic() < end and len(gave_up) < 2:
                for name, status in world.keep_up().items():
                    gave_up.setdefault(name, status)
                time.sleep(0.2)
            if not gave_up or set(gave_up.values()) != {3}:
                raise Failed(f"exit statuses on a full disk: {gave_up}")
            world.most_bytes = None
            for service in SERVICES:
                world.processes[service].terminate()
                world.processes[service].wait()
                world.start(service)
            while replay.poll() is None and time.monotonic() < end + PATIENCE_S:
                world.keep_up()
                time.sleep(0.2)
            if difference := settle(world, self.undisturbed):
                raise Failed(difference)
        return f"{', '.join(gave_up)} gave up with exit status 3; with room again: results identical"

    def read_only(self):
        state = self.folder / "read-only"
        shutil.copytree(self.kept, state)
        script = 'mount --bind "$1" "$1" && mount -o remount,bind,ro "$1" && shift && exec "$@"'
        namespace = ["unshare", "-m"] if os.geteuid() == 0 else ["unshare", "-Urm"]
        for service in SERVICES:
            done = subprocess.run([*namespace, "sh", "-c", script, "sh", state, self.binaries / f"sealwatch-{service}",
                                   "--config", self.folder, "--state", state], capture_output=True, text=True, timeout=30)
            if done.returncode not in (2, 3) or "read" not in done.stderr.lower():
                raise Failed(f"{service}: exit status {done.returncode}: {done.stderr}")
        with World(self.binaries, self.folder, state) as world:
            world.start_all()
            time.sleep(3.0)
            if ended := world.keep_up():
                raise Failed(f"does not start afterwards: {ended}")
            if difference := settle(world, self.kept_results, 10.0):
                raise Failed(difference)
        return "each service refuses with the reason; writable again: starts, results identical"


    def clock_steps(self):
        """The wall clock of all services is set, forward and back, by a second to a year, while tests are played."""
        file = self.folder / "clock"
        file.write_bytes(struct.pack("q", 0))
        shim = {"LD_PRELOAD": str(self.binaries / "campaign/libclock_shim.so"), "CAMPAIGN_CLOCK": str(file)}
        told, steps = False, []
        with World(self.binaries, self.folder, environment=shim) as world:
            world.start_all()
            replay, end = world.replay(self.files), time.monotonic() + PATIENCE_S
            while (replay.poll() is None or len(steps) < self.arguments.steps) and time.monotonic() < end:
                step_s = self.random.choice([-1, 1]) * 10 ** self.random.uniform(0.0, 7.5)
                steps.append(step_s)
                with open(file, "r+b") as clock:
                    clock.write(struct.pack("q", int(sum(steps) * 1e9)))
                time.sleep(self.random.uniform(0.5, 2.5))
                told = told or '"clock_step"' in world.run("status", "--json", "--seconds", "1").stdout
                if ended := world.keep_up():
                    raise Failed(f"after {len(steps)} steps ended: {ended}")
            if difference := settle(world, self.undisturbed):
                raise Failed(f"after {len(steps)} steps: {difference}")
        if not told:
            raise Failed("no service said that its clock was set")
        largest = max(map(abs, steps)) / 86400
        return f"{len(steps)} steps of up to {largest:.0f} days, both ways: results identical, told as an alarm"

    def two_hosts(self):
        """Acquisition and manipulation on one host, the rest on another; the wire loses 10 %, reorders, and is cut."""
        with Wire(self.random) as wire:
            here, there = (["nsenter", f"--net=/run/netns/{name}"] for name in wire.hosts)
            prefixes = {service: here if service in SERVICES[:2] else there for service in SERVICES}
            with World(self.binaries, self.folder, interface="wire", prefixes=prefixes | {"replay": here}) as world:
                world.start_all()
                time.sleep(3.0)  # they find each other while all is well
                wire.bad = True
                replay, cuts, end = world.replay(self.files), 0, time.monotonic() + PATIENCE_S
                while replay.poll() is None and time.monotonic() < end:
                    time.sleep(self.random.uniform(0.5, 3.0))
                    wire.cut(1.0)
                    cuts += 1
                if replay.poll() is None:
                    said = world.says()
                    replay.kill()
                    raise Failed(f"after {cuts} cuts the replay did not end in {PATIENCE_S:.0f} s; {said}")
                difference = settle(world, self.undisturbed)
                if ended := world.keep_up():
                    raise Failed(f"after {cuts} cuts ended: {ended}")
                if difference:
                    raise Failed(f"after {cuts} cuts: {difference}")
        share = 100.0 * wire.lost / (wire.lost + wire.carried)
        return f"{wire.lost} packets lost ({share:.0f} %), {cuts} cuts of 1 s: results identical"

    def flood(self):
        """Actuators live, fifty by default, first alone and then while a stranger sends as fast as DDS takes it."""
        (self.folder / "live/assets").mkdir(parents=True)
        text = (SOURCE / "config/assets/xt03-mv2.yaml").read_text()
        for name in [*(f"LIVE-{k}" for k in range(1, self.arguments.live + 1)), "FLOOD-KNOWN"]:
            (self.folder / f"live/assets/{name.lower()}.yaml").write_text(text.replace("asset_id: XT03-MV2", f"asset_id: {name}"))
        text = (SOURCE / "config/sealwatch.yaml").read_text()
        (self.folder / "live/sealwatch.yaml").write_text(text.replace("domain: 0 ", f"domain: {LIVE_DOMAIN} "))
        said = []
        for what in self.arguments.floods.split(","):
            said.append(self.flood_of(what))
        return "; ".join(said)

    def flood_of(self, what):
        seconds = self.arguments.seconds
        perf = self.binaries / "perf/live_latency"
        with World(self.binaries, self.folder / "live") as world:
            world.start_all()
            # To a file: a pipe is full within half a second, and a reader that then stops holds up who sends.
            arrived = self.folder / f"arrived-{what}"
            with open(arrived, "w") as output:
                reader = subprocess.Popen([perf, "receive", str(2 * seconds + 24)], env=world.environment, stdout=output)
            sender = subprocess.Popen([perf, "send", "spread", str(self.arguments.live), str(2 * seconds + 12)], env=world.environment)
            time.sleep(6.0)  # joined, and every layer has met its first blocks
            shares = [self.busy(world, lambda: time.sleep(seconds))]  # what there is without a flood
            before, flood_ns = world.sizes(), time.time_ns()
            stranger = None if what == "nothing" else subprocess.Popen(
                [self.binaries / "campaign/flood", what, str(seconds), str(LIVE_DOMAIN)], env=world.environment,
                stdout=subprocess.PIPE, text=True)
            if stranger:
                shares.append(self.busy(world, stranger.wait))
            load, end_ns = os.getloadavg()[0], time.time_ns() if stranger else sys.maxsize
            status = world.run("status", "--json", "--seconds", "1").stdout
            reader.wait()
            sent = int(stranger.communicate()[0]) if stranger else 0
            if sender.wait() != 0:
                raise Failed(f"flood of {what}: the actuators could not send")
            after = world.sizes()
            places = latencies_ms(what, arrived, world.state / "data_manipulation.db")
            beside = [ms for sampled, ms in places if flood_ns <= sampled < end_ns]
            alone = [ms for sampled, ms in places if flood_ns - seconds * 10**9 <= sampled < flood_ns]
            if ended := world.keep_up():
                raise Failed(f"flood of {what}: ended: {ended}")
        if not alone or not beside:
            raise Failed(f"flood of {what}: {len(alone)} live blocks before it and {len(beside)} beside it")
        # What fits into the queues for strangers is no flood.
        if what in ("raw", "known") and sent > 5000 and not re.search(r'"kind":\s*"flood"', status):
            raise Failed(f"flood of {what}: {sent} messages, and nobody said so")
        grown = {name: after[name][0] - before[name][0] for name in SERVICES}
        most = max(grown, key=grown.get)
        if grown[most] > MOST_GROWTH_MB:
            raise Failed(f"flood of {what}: {most} grew by {grown[most]:.0f} MB")
        return (f"{what}: {sent} messages, {len(places)} live blocks all there, p50 {quantile(beside, 0.5):.1f}"
                f" p99 {quantile(beside, 0.99):.1f} ms, before it {quantile(alone, 0.5):.1f} and"
                f" {quantile(alone, 0.99):.1f} ms, load {load:.0f}; {most} grew most, by {grown[most]:.0f} MB;"
                f" ms of a processor per second: {', before it '.join(shares[::-1])}")

    def busy(self, world, waits):
        """Of each service, while one waits."""
        begin, before = time.monotonic(), {name: cpu_s(process.pid) for name, process in world.processes.items()}
        waits()
        took = time.monotonic() - begin
        return " ".join(f"{1000 * (cpu_s(process.pid) - before[name]) / took:.0f}" for name, process in world.processes.items())

    def messages(self):
        """One true message of each topic, as somebody may have overheard it."""
        found = {}
        for service in SERVICES:
            with sqlite3.connect(f"file:{self.kept / database(service)}?mode=ro", uri=True) as journal:
                for topic, payload in journal.execute("SELECT topic, payload FROM outputs WHERE payload NOT NULL"):
                    found[topic] = json.loads(payload)
        block = found["sample_block"]
        asset, header = block["asset_id"], dict(block["header"], pst_id="", source_ids=[])
        found["raw_samples"] = {
            "header": dict(header, message_id="raw"), "asset_id": asset, "recording_id": "x", "source_id": "stranger",
            "test_kind": "pst", "block_number": 0, "boundary": "begin", "samples": block["samples"],
            "start_time_known": True, "start_time_ns": header["event_time_ns"]}
        found["acknowledgement"] = {"header": dict(header, message_id="acknowledgement/a/1"), "asset_id": asset,
                                    "advisory_id": "a", "acknowledged_by": "x", "remark": "y"}
        found["maintenance_event"] = {"header": dict(header, message_id="event"), "asset_id": asset,
                                      "kind": "actuator_replaced", "reported_by": "x"}
        return "".join(json.dumps({"topic": topic, "message": message}) + "\n" for topic, message in found.items())

    def poison(self):
        """Every field of every message spoilt in every way. Another asset's conclusions are the same as without."""
        folder = self.folder / "poison"
        (folder / "assets").mkdir(parents=True)
        text = (SOURCE / "config/assets/xt03-mv2.yaml").read_text()
        (folder / "assets/xt03-mv2.yaml").write_text(text)
        (folder / "assets/poisoned.yaml").write_text(text.replace("asset_id: XT03-MV2", "asset_id: POISONED"))
        (folder / "sealwatch.yaml").write_text((self.folder / "sealwatch.yaml").read_text())
        messages = self.messages().replace("XT03-MV2", "POISONED")
        with World(self.binaries, folder) as world:
            world.start_all()
            world.wait_until_running()
            before, sent = world.sizes(), 0
            replay = world.replay(self.files)
            for name in ("nameless", "named"):
                done = subprocess.run([self.binaries / "campaign/poison", str(DOMAIN), name], env=world.environment,
                                      input=messages, capture_output=True, text=True)
                if done.returncode != 0:
                    raise Failed(f"the poisoner: {done.stderr}")
                sent += int(done.stdout)
            if replay.wait(PATIENCE_S) != 0:
                raise Failed("the replay beside the poison did not end well")
            time.sleep(2.0)
            if ended := world.keep_up():
                raise Failed(f"after {sent} spoilt messages ended: {ended}")
            grown = {name: size[0] - before[name][0] for name, size in world.sizes().items()}
            status_kB = len(world.run("status", "--json", "--seconds", "1").stdout) / 1000
            results = world.results()
        mine = {service: {one: text for one, text in results[service].items() if one in self.undisturbed[service]}
                for service in SERVICES}
        if difference := differences(self.undisturbed, mine):
            raise Failed(f"after {sent} spoilt messages: {difference}")
        if status_kB > MOST_STATUS_KB:
            raise Failed(f"after {sent} spoilt messages the status has {status_kB:.0f} kB")
        most = max(grown, key=grown.get)
        if grown[most] > MOST_GROWTH_MB:
            raise Failed(f"after {sent} spoilt messages {most} grew by {grown[most]:.0f} MB")
        return (f"{sent} spoilt messages: another asset's results identical, status {status_kB:.0f} kB;"
                f" {most} grew most, by {grown[most]:.0f} MB")

    def fleet_of(self, name, assets, more=""):
        """A folder with a configuration of such actuators, all alike."""
        folder = self.folder / name
        (folder / "assets").mkdir(parents=True)
        text = (SOURCE / "config/assets/xt03-mv2.yaml").read_text()
        for asset in assets:
            (folder / f"assets/{asset}.yaml").write_text(text.replace("asset_id: XT03-MV2", f"asset_id: {asset}"))
        (folder / "sealwatch.yaml").write_text((self.folder / "sealwatch.yaml").read_text() + more)
        return folder

    def simulated(self, folder, rate, *words, asset=SOURCE / "config/assets/xt03-mv2.yaml"):
        subprocess.run([self.binaries / "sealwatch", "simulate", "--asset", asset, "--rate", str(rate), "--out", folder, *words],
                       check=True, stdout=subprocess.DEVNULL)
        return sorted(folder.glob("*.csv"))

    def overdue(self):
        """A test on which a layer is beyond its deadline is set aside, alone, until somebody has it tried again."""
        folder = self.fleet_of("overdue", ["XT03-MV2", "LARGE"])
        configuration = (folder / "sealwatch.yaml").read_text()
        strict = "  state_detection: {enabled: true, deadline_s: 0.5}\n"
        (folder / "sealwatch.yaml").write_text(configuration.replace("  state_detection: {enabled: true}\n", strict))
        large = copy_for("LARGE", self.simulated(folder / "large", 5000)[0], folder)
        small = copy_for("LARGE", self.simulated(folder / "small", 50, "--start", "2009-06-01T10:00:00Z")[0], folder)
        with World(self.binaries, folder) as world:
            world.start_all()
            world.wait_until_running()
            replay = world.replay([large, *self.files, small])
            self.wait_for(world, "the large test is set aside", lambda: set_aside(world))
            self.check_set_aside(world)
            replay.wait(PATIENCE_S)
            world.kill("state-detection")
            self.check_set_aside(world)
            world.stop()
            for file in world.state.glob("state_detection.*"):
                file.unlink()
            world.start_all()
            self.wait_for(world, "its journal was lost, and it is set aside again", lambda: set_aside(world))
            self.check_set_aside(world)
            message = set_aside(world)[0]["message_id"]
            world.stop()
            (folder / "sealwatch.yaml").write_text(configuration)
            world.start_all()
            world.wait_until_running()
            self.check_set_aside(world)
            asked = world.run("quarantine", "retry", message, "--by", "campaign", "--state", world.state)
            if asked.returncode != 0:
                raise Failed(f"nobody may have it tried again: {asked.stderr}")
            self.wait_for(world, "it is concluded", lambda: len(estimated(world, "LARGE")) == 2)
            self.wait_for(world, "its alarm ends", lambda: not alarms_of(world, "LARGE"))
        return f"{message} set aside after two tries, after a kill and with a lost journal; all else identical; tried again: concluded"

    def wait_for(self, world, what, happens):
        end = time.monotonic() + PATIENCE_S
        while not happens():
            world.keep_up()  # what a layer computes without asking whether to stop costs its service a start
            if time.monotonic() > end:
                raise Failed(f"in {PATIENCE_S:.0f} s it does not come to that: {what}")
            time.sleep(0.5)

    def check_set_aside(self, world):
        """The large test, and it alone: the other asset's results are there, and those of its own other test."""
        reason = "did not end within 0.5 s"
        self.wait_for(world, "status tells of it", lambda: any(reason in alarm["text"] for alarm in alarms_of(world, "LARGE")))
        listed = set_aside(world)
        if len(listed) != 1 or reason not in listed[0]["reason"] or listed[0]["service"] != "state_detection":
            raise Failed(f"set aside: {listed}")
        mine = lambda: {service: {one: text for one, text in outputs.items() if one in self.undisturbed[service]}
                        for service, outputs in world.results().items()}
        self.wait_for(world, "all else is concluded", lambda: not differences(self.undisturbed, mine()) and len(estimated(world, "LARGE")) == 1)

    def leaks(self):
        """Six hidden leaks are analysed at once, which takes minutes. The tests of others are concluded meanwhile."""
        leaking = [f"LEAK-{k}" for k in range(1, 7)]
        folder = self.fleet_of("leaks", [*leaking, "BEFORE", "BESIDE"])
        text = (SOURCE / "config/assets/xt03-mv2.yaml").read_text()
        (folder / "leak.yaml").write_text(text + "physics: [{id: external_leakage, element: chamber_a, parameters: {G: 1.0e-13}}]\n")
        well = self.simulated(folder / "well", 10, "--months", "6", "--seed", "5")
        leak = self.simulated(folder / "leak", 10, "--months", "3", "--seed", "6", "--start", "2010-03-17T10:00:00Z",
                              asset=folder / "leak.yaml")
        with World(self.binaries, folder) as world:
            world.start_all()
            world.wait_until_running()
            before_s = self.seconds_of_replay(world, "BEFORE", well)
            replay = world.replay([copy_for(name, file, folder) for file in well + leak for name in leaking])
            self.wait_for(world, "all are analysed", lambda: len(analysed(world, leaking, len(well + leak))) == 6)
            beside_s = self.seconds_of_replay(world, "BESIDE", well)
            if replay.poll():
                raise Failed("the replay of leaking actuators gave up")
            left = [name for name, is_done in analysed(world, leaking, len(well + leak)).items() if not is_done]
            if ended := world.keep_up():
                raise Failed(f"ended: {ended}")
            subprocess.run(["pkill", "-P", str(replay.pid)], check=False)  # it would wait for all analyses
            replay.wait()
        if len(left) < 3:
            raise Failed(f"only {len(left)} analyses went on after {beside_s:.0f} s, {before_s:.0f} s before them")
        return f"{len(well)} tests in {beside_s:.1f} s beside six analyses, of which {len(left)} went on, and in {before_s:.1f} s before them"

    def seconds_of_replay(self, world, name, recordings):
        begin = time.monotonic()
        replayed(world, [copy_for(name, file, world.folder) for file in recordings])
        return time.monotonic() - begin

    def years(self):
        """A fleet's tests, month by month, at full speed: memory, descriptors and start-up are those of its first years."""
        fleet = self.folder / "fleet"
        (fleet / "assets").mkdir(parents=True)
        text = (SOURCE / "config/sealwatch.yaml").read_text()
        (fleet / "sealwatch.yaml").write_text(text.replace("domain: 0 ", f"domain: {DOMAIN} "))
        asset = (SOURCE / "config/assets/xt03-mv2.yaml").read_text()
        names = [f"FLEET-{k}" for k in range(1, self.arguments.assets + 1)]
        for name in names:
            (fleet / f"assets/{name}.yaml").write_text(asset.replace("XT03-MV2", name))
        (fleet / "life").mkdir()
        begun, rows, part = time.monotonic(), [], -(-len(self.files) // 4)
        with World(self.binaries, fleet) as world:
            world.start_all()
            for first in range(0, len(self.files), part):
                played = [copy_for(name, file, fleet / "life") for file in self.files[first:first + part] for name in names]
                if world.replay(played).wait(PATIENCE_S * 10) != 0:
                    raise Failed(f"the replay of tests {first + 1} to {first + part} did not end well")
                time.sleep(2.0)
                sizes = world.sizes()
                world.stop()
                start_s = self.start_up_s(world)
                rows.append((min(first + part, len(self.files)), sum(size[0] for size in sizes.values()), max(size[1] for size in sizes.values()),
                             start_s, sum(file.stat().st_size for file in world.state.glob("*.db")) / 1e6))
        tests, memory, descriptors, start, disk = rows[-1]
        told = "; ".join(f"after {row[0]} months {row[1]:.0f} MB, {row[2]} descriptors, start {row[3]:.1f} s, disk {row[4]:.0f} MB"
                         for row in rows)
        if descriptors > rows[0][2] + 4 or memory > rows[0][1] + MOST_GROWTH_MB or start > LONGEST_START_S:
            raise Failed(told)
        return f"{len(names)} assets, {tests * len(names)} tests in {time.monotonic() - begun:.0f} s: {told}"

    def history(self):
        """On a journal of three times as many tests a service looks at as many pages before it is ready."""
        assets, few, many = 8, 16, 48  # more than it looks at for damage
        told = []
        for service in SERVICES:
            short, long = (self.pages_of_start(service, assets, turns) for turns in (few, many))
            grown = [f"{text}: {short.get(text, 0)} and {pages}" for text, pages in long.items()
                     if pages > 2 * short.get(text, 0) + MOST_MORE_PAGES and not any(one in text for one in BOUNDED)]
            if grown:
                raise Failed(f"{service} looks at more pages the longer its history: {grown}")
            told.append(f"{service} {sum(short.values())} and {sum(long.values())}")
        return f"pages looked at on {few} and {many} x {len(self.files)} tests of {assets} assets: {', '.join(told)}"

    def pages_of_start(self, service, assets, turns):
        """By statement: what its start looked at in a journal of so many assets, with all tests in each turn."""
        state = self.folder / f"history-{service}-{turns}"
        state.mkdir()
        subprocess.run([self.binaries / "perf/long_history", self.kept / database(service), state / database(service), "XT03-MV2",
                        str(assets), str(turns)], check=True, stdout=subprocess.DEVNULL)
        shim = {"PAGES_READ": str(state / "pages"), "LD_PRELOAD": str(self.binaries / "campaign/libpages_read.so")}
        with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as manager:
            manager.bind(str(state / "notify"))
            manager.settimeout(PATIENCE_S)
            with World(self.binaries, self.folder, state, environment=dict(shim, NOTIFY_SOCKET=str(state / "notify"))) as world:
                world.start(service)
                while b"READY=1" not in manager.recv(4096):
                    pass
                lines = (state / "pages").read_text().splitlines()
        pages = {}
        for count, text in (line.split("\t", 1) for line in lines if "\t" in line):
            text = re.sub(r"\d+", "N", text)
            pages[text] = pages.get(text, 0) + int(count)
        shutil.rmtree(state)
        return pages

    def packed(self):
        """Services that read their past from what they packed go on as those that read it all from JSON, a retraction in it."""
        files = self.simulated(self.folder / "packed", 20, "--months", "24", "--seed", "3")
        first, rest = files[:20], files[20:]
        with World(self.binaries, self.folder) as world:
            world.start_all()
            world.wait_until_running()
            replayed(world, first)
            test = sorted(world.results()["state-detection"])[2].split("/")[1]
            if (retracted := world.run("retract", "XT03-MV2", "--test", test, "--by", "campaign", "--reason", "a trial")).returncode != 0:
                raise Failed(f"the retraction was not taken: {retracted.stderr}")
            time.sleep(2.0)  # all layers have concluded anew
            world.stop()
            self.start_up_s(world)  # packs
            world.stop()
            base = world.state
        # Each with how many services say that they read all of it.
        changes = {"packed": (None, 0), "not packed": ("DELETE FROM packed_outputs", 0),
                   "damaged": ("UPDATE packed_outputs SET body = 'A' || body", len(SERVICES)),
                   "of another build": ("UPDATE packed_outputs SET layout = 'another'", len(SERVICES))}
        results = {name: self.gone_on(base, name.replace(" ", "-"), rest, *change) for name, change in changes.items()}
        for name, found in results.items():
            if difference := differences(results["not packed"], found):
                raise Failed(f"{name}: {difference}")
        return f"{len(first)} tests, a retraction, a start, {len(rest)} tests: identical {', '.join(results)}"

    def gone_on(self, base, name, files, change, refusals):
        """The results of the rest of the tests on a copy of the state, with a change of what is packed in it."""
        state = self.folder / f"state-{name}"
        shutil.copytree(base, state)
        shutil.rmtree(state / "log")
        for service in SERVICES:
            with contextlib.closing(sqlite3.connect(state / database(service))) as journal, journal:
                if journal.execute("SELECT count(*) FROM packed_outputs").fetchone()[0] == 0:
                    raise Failed(f"{service} has packed nothing")
                if change:
                    journal.execute(change)
        with World(self.binaries, self.folder, state) as world:
            world.start_all()
            world.wait_until_running()
            replayed(world, files)
            world.stop()
            logs = "".join(file.read_text() for file in (state / "log").glob("*.log"))
            if (told := logs.count("the packed past is not used")) != refusals:
                raise Failed(f"{name}: {told} services say that they read all of their past")
            return world.results()

    def start_up_s(self, world):
        """All are left running."""
        begin = time.monotonic()
        world.start_all()
        world.wait_until_running()
        return time.monotonic() - begin


class Wire(threading.Thread):
    """Two hosts as network namespaces and the cable between them: what this thread does with each packet. It takes root
    and /dev/net/tun, no traffic shaper of the kernel."""
    LOSS, LATE, LATEST_S = 0.1, 0.25, 0.005  # share that is lost; share that comes later than what follows, by how much

    def __init__(self, choices):
        super().__init__(daemon=True)
        self.hosts = [f"campaign-{os.getpid()}-{side}" for side in ("here", "there")]
        self.random, self.taps = choices, []
        self.bad, self.is_cut, self.over, self.lost, self.carried = False, False, False, 0, 0

    def __enter__(self):
        for number, host in enumerate(self.hosts, 1):
            self.ip("netns", "add", host)
            self.taps.append(self.tap_in(host))
            self.ip("-n", host, "link", "set", "lo", "up")
            self.ip("-n", host, "address", "add", f"10.77.0.{number}/24", "dev", "wire")
            self.ip("-n", host, "link", "set", "wire", "up", "multicast", "on")
            self.ip("-n", host, "route", "add", "224.0.0.0/4", "dev", "wire")
        self.start()
        return self

    def __exit__(self, *_):
        self.over = True
        self.join()
        for tap in self.taps:
            os.close(tap)
        for host in self.hosts:
            subprocess.run(["ip", "netns", "del", host], check=False)

    @staticmethod
    def ip(*words):
        subprocess.run(["ip", *words], check=True)

    @staticmethod
    def tap_in(host):
        """The network device `wire` of the host, as a file of its packets."""
        tun_set_interface, tap_without_header, network_namespace = 0x400454CA, 0x1002, 0x40000000
        libc = ctypes.CDLL(None, use_errno=True)
        with open("/proc/thread-self/ns/net") as own, open(f"/run/netns/{host}") as other:
            if libc.setns(other.fileno(), network_namespace) != 0:
                raise Failed("no right to enter a network namespace")
            try:
                tap = os.open("/dev/net/tun", os.O_RDWR | os.O_NONBLOCK | os.O_CLOEXEC)
                fcntl.ioctl(tap, tun_set_interface, struct.pack("16sH22x", b"wire", tap_without_header))
            finally:
                libc.setns(own.fileno(), network_namespace)
        return tap

    def run(self):
        late, count = [], 0
        while not self.over:
            wait_s = max(0.0, min(0.1, late[0][0] - time.monotonic())) if late else 0.1
            for tap in select.select(self.taps, [], [], wait_s)[0]:
                packet, other = os.read(tap, 65536), self.taps[1 - self.taps.index(tap)]
                if self.is_cut or (self.bad and self.random.random() < self.LOSS):
                    self.lost += 1
                elif self.bad and self.random.random() < self.LATE:
                    count += 1
                    heapq.heappush(late, (time.monotonic() + self.random.uniform(0.0, self.LATEST_S), count, other, packet))
                else:
                    self.carry(other, packet)
            while late and late[0][0] <= time.monotonic():
                _, _, other, packet = heapq.heappop(late)
                self.carry(other, packet)

    def carry(self, tap, packet):
        try:
            os.write(tap, packet)
            self.carried += 1
        except OSError:  # its queue is full, as a switch's may be
            self.lost += 1

    def cut(self, seconds):
        self.is_cut = True
        time.sleep(seconds)
        self.is_cut = False


def copy_for(name, recording, folder):
    """The recording as one of another actuator."""
    copy = folder / f"{name}-{recording.name}"
    copy.symlink_to(recording)
    sidecar = recording.with_suffix(".yaml")
    copy.with_suffix(".yaml").write_text(sidecar.read_text().replace("XT03-MV2", name))
    return copy


def latencies_ms(what, arrived, journal, patience_s=60.0):
    """Of each live block, when its last sample was taken, and from then to its receipt in data manipulation's journal; none may be missing there
    in the end. The reader of raw blocks, which asks for nothing again, may miss some: those are not timed."""
    sampled = {}
    for line in arrived.read_text().splitlines():
        topic, asset, _, block, sent, _ = line.split()
        if topic == "raw" and asset.startswith("LIVE-"):
            sampled[asset, int(block.split("/")[1])] = int(sent)
    end = time.monotonic() + patience_s
    while sampled.keys() - (received := received_at(journal)).keys() and time.monotonic() < end:
        time.sleep(1.0)  # late, not lost
    if missing := sampled.keys() - received.keys():
        raise Failed(f"{what}: {len(missing)} of {len(sampled)} live blocks are not there after {patience_s:.0f} s, "
                     f"{sorted(missing)[0]}")
    return [(sampled[block], (received[block] - sampled[block]) * 1e-6) for block in sampled]


def received_at(journal):
    """Asset and number of each block that data manipulation has received, and when."""
    with sqlite3.connect(f"file:{journal}?mode=ro", uri=True, timeout=10) as opened:
        return {(asset, int(message.rsplit("/", 1)[1])): when for asset, message, when in opened.execute(
            "SELECT asset_id, message_id, received FROM inputs WHERE topic = 'sample_block'")}


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("binaries")
    parser.add_argument("trial", nargs="?", default="all")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--kills", type=int, default=8)
    parser.add_argument("--bits", type=int, default=6)
    parser.add_argument("--damages", type=int, default=0, help="so many, drawn; 0: each to each journal")
    parser.add_argument("--tests", type=int, default=8)
    parser.add_argument("--steps", type=int, default=10)
    parser.add_argument("--seconds", type=int, default=20)
    parser.add_argument("--assets", type=int, default=2)
    parser.add_argument("--floods", default="nothing,raw,known,statuses,resends")
    parser.add_argument("--live", type=int, default=50)
    arguments = parser.parse_args()
    trials = list(TRIALS) if arguments.trial == "all" else [arguments.trial]
    folder = pathlib.Path(tempfile.mkdtemp(prefix="sealwatch-campaign-"))
    campaign = Campaign(arguments, folder)
    # Those that compare nothing with an undisturbed run need none.
    advisories = campaign.prepare() if set(trials) - {"flood", "leaks", "years"} else 0
    print(f"campaign, seed {arguments.seed}: {len(campaign.files)} tests, {advisories} advisories", flush=True)
    failed = False
    for trial in trials:
        begin = time.monotonic()
        try:
            said = getattr(campaign, trial)()
            if found := findings(folder):
                raise Failed(f"{said}; but sanitizers found {len(found)}: {found[0]}")
        except Failed as failure:
            failed, said = True, f"FAILED: {failure}"
        print(f"{trial}, seed {arguments.seed}, {time.monotonic() - begin:.0f} s: {said}", flush=True)
    if failed:
        print(f"left for a look: {folder}")
    else:
        shutil.rmtree(folder)
    sys.exit(failed)


main()
