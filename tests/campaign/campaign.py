#!/usr/bin/python3
"""Faults under which the six real services must end with the results of an undisturbed run: killed at random moments,
bits turned in every table of their journals, a full disk, a disk that cannot be written. One line for each trial, with
its seed: the same seed makes the same choices, though not the same moments.
Usage: campaign.py BIN_DIRECTORY [kills|bits|full_disk|read_only|all] [--seed N] [--kills N] [--bits N] [--tests N]
"""
import argparse
import os
import pathlib
import random
import resource
import shutil
import signal
import sqlite3
import subprocess
import sys
import tempfile
import time

SOURCE = pathlib.Path(__file__).resolve().parents[2]
SERVICES = ["data-acquisition", "data-manipulation", "state-detection", "health-assessment", "prognostic-assessment",
            "advisory-generation"]
DOMAIN, PATIENCE_S = 96, 240.0
TABLES = {"inputs": ["message_id", "payload", "consumed", "pst_id"], "outputs": ["payload", "asset_id", "checksum"],
          "positions": ["sequence", "writer_id"], "quarantine": ["reason"], "acts": ["who", "hash"],
          "meta": ["value"]}


class Failed(Exception):
    pass


def database(service):
    return service.replace("-", "_") + ".db"


class World:
    """A state directory with its services, in a discovery tag of their own."""
    count = 0

    def __init__(self, binaries, folder, state=None):
        World.count += 1
        self.binaries, self.folder = binaries, folder
        self.state = state or folder / f"state-{World.count}"
        self.state.mkdir(exist_ok=True)
        uri = ('<CycloneDDS><Domain Id="any"><General><Interfaces><NetworkInterface name="lo" multicast="true"/>'
               '</Interfaces></General><Discovery><LeaseDuration>2s</LeaseDuration>'
               f'<Tag>campaign-{os.getpid()}-{World.count}</Tag></Discovery></Domain></CycloneDDS>')
        self.environment = dict(os.environ, CYCLONEDDS_URI=uri)
        self.processes, self.most_bytes = {}, None

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.stop()

    def limit(self):
        """In a service: files no longer than that, as on a full disk."""
        if self.most_bytes:
            signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
            resource.setrlimit(resource.RLIMIT_FSIZE, (self.most_bytes, resource.RLIM_INFINITY))

    def start(self, service):
        log = open(self.folder / "services.log", "a")
        self.processes[service] = subprocess.Popen(
            [self.binaries / f"sealwatch-{service}", "--config", self.folder, "--state", self.state],
            env=self.environment, stdout=log, stderr=log, preexec_fn=self.limit)

    def start_all(self):
        for service in SERVICES:
            self.start(service)

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
        return subprocess.Popen([*self.command("replay"), "--quiet", *map(str, files)], env=self.environment,
                                stdout=subprocess.DEVNULL, stderr=open(self.folder / "replay.log", "a"))

    def run(self, *words):
        return subprocess.run(self.command(*words), env=self.environment, capture_output=True, text=True)

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


class Campaign:
    def __init__(self, arguments, folder):
        self.arguments, self.folder = arguments, folder
        self.binaries = pathlib.Path(arguments.binaries).resolve()
        self.random = random.Random(arguments.seed)
        text = (SOURCE / "config/sealwatch.yaml").read_text()
        (folder / "sealwatch.yaml").write_text(text.replace("domain: 0 ", f"domain: {DOMAIN} "))
        (folder / "assets").symlink_to(SOURCE / "config/assets")
        subprocess.run([self.binaries / "sealwatch", "simulate", "--asset", SOURCE / "config/assets/xt03-mv2.yaml",
                        "--ageing", "--months", str(arguments.tests), "--rate", "50", "--seed", "7", "--out",
                        folder / "life"], check=True, stdout=subprocess.DEVNULL)
        self.files = sorted((folder / "life").glob("*.csv"))
        self.undisturbed, self.kept, self.kept_results = None, None, None

    def prepare(self):
        """The results of an undisturbed run, and its state after a retraction."""
        with World(self.binaries, self.folder) as world:
            world.start_all()
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
                    replay.kill()
                    raise Failed(f"after {done} kills the replay did not end in {PATIENCE_S:.0f} s")
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


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("binaries")
    parser.add_argument("trial", nargs="?", default="all")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--kills", type=int, default=8)
    parser.add_argument("--bits", type=int, default=6)
    parser.add_argument("--tests", type=int, default=8)
    arguments = parser.parse_args()
    trials = ["kills", "bits", "full_disk", "read_only"] if arguments.trial == "all" else [arguments.trial]
    folder = pathlib.Path(tempfile.mkdtemp(prefix="sealwatch-campaign-"))
    campaign = Campaign(arguments, folder)
    print(f"campaign, seed {arguments.seed}: {len(campaign.files)} tests, {campaign.prepare()} advisories", flush=True)
    failed = False
    for trial in trials:
        begin = time.monotonic()
        try:
            said = getattr(campaign, trial)()
        except Failed as failure:
            failed, said = True, f"FAILED: {failure}"
        print(f"{trial}, seed {arguments.seed}, {time.monotonic() - begin:.0f} s: {said}", flush=True)
    if failed:
        print(f"left for a look: {folder}")
    else:
        shutil.rmtree(folder)
    sys.exit(failed)


main()
