#!/usr/bin/python3
"""The reference senders and the subscriber of docs/examples against the real data acquisition, all of them killed with
SIGKILL at random moments: every block is journaled once and in order; the subscriber hears nothing twice, nothing
backwards, and the last block. Usage: reference_senders.py SOURCE BIN_DIRECTORY CPP_SENDER [SEED]
"""
import os
import pathlib
import random
import signal
import sqlite3
import subprocess
import sys
import tempfile
import time

SOURCE, BIN, CPP_SENDER = (pathlib.Path(word).resolve() for word in sys.argv[1:4])
SEED = int(sys.argv[4]) if len(sys.argv) > 4 else 1
ASSET, BLOCKS, KILLS, PATIENCE_S = "XT03-MV2", 1200, 12, 240.0


def environment():
    uri = ('<CycloneDDS><Domain Id="any"><General><Interfaces><NetworkInterface name="lo" multicast="true"/></Interfaces>'
           f'</General><Discovery><LeaseDuration>2s</LeaseDuration><Tag>senders-{os.getpid()}</Tag></Discovery></Domain>'
           '</CycloneDDS>')
    return dict(os.environ, CYCLONEDDS_URI=uri, PATH=f"{BIN}:{os.environ['PATH']}")


class Victim:
    """A program that is started again whenever it was killed, with what it started itself."""

    def __init__(self, command, output=subprocess.DEVNULL):
        self.command, self.output, self.process, self.done = [str(word) for word in command], output, None, False
        self.start()

    def start(self):
        self.process = subprocess.Popen(self.command, env=ENVIRONMENT, stdout=self.output, stderr=subprocess.DEVNULL,
                                        start_new_session=True)

    def look(self):
        """Whether it has ended by itself, and well."""
        if not self.done and self.process.poll() is not None:
            self.done = self.process.returncode == 0
            if not self.done:
                self.start()
        return self.done

    def children(self):
        tasks = pathlib.Path(f"/proc/{self.process.pid}/task/{self.process.pid}/children")
        return [int(word) for word in tasks.read_text().split()] if tasks.exists() else []

    def kill(self, choose):
        """The program with all that it started, or only what it started."""
        children = self.children()
        if children and choose.random() < 0.5:
            os.kill(choose.choice(children), signal.SIGKILL)
        else:
            self.end()

    def end(self):
        try:
            os.killpg(self.process.pid, signal.SIGKILL)
        except ProcessLookupError:
            pass
        self.process.wait()


def numbers(rows):
    return [int(message_id.rsplit("/", 1)[1]) for message_id, in rows]


def check(condition, text):
    if not condition:
        sys.exit(f"reference_senders, seed {SEED}: {text}")


def run(name, sender_command, folder, choose):
    state, heard = folder / "state", folder / "heard"
    with open(heard, "ab") as output:
        service = Victim([BIN / "sealwatch-data-acquisition", "--config", SOURCE / "config", "--state", state])
        subscriber = Victim([sys.executable, SOURCE / "docs/examples/subscriber_python/subscriber.py", "sample_block",
                             folder / "positions", SOURCE / "config"], output)
        time.sleep(1.0)
        sender = Victim(sender_command)
        victims = [service, sender, subscriber]
        kills, end, next_kill = 0, time.monotonic() + PATIENCE_S, time.monotonic() + 0.3
        while not sender.look() and time.monotonic() < end:
            service.look(), subscriber.look()
            if kills < KILLS and time.monotonic() > next_kill:
                choose.choice(victims).kill(choose)
                kills, next_kill = kills + 1, time.monotonic() + choose.uniform(0.1, 1.0)
            time.sleep(0.02)
        check(sender.done, f"{name} did not end within {PATIENCE_S:.0f} s")
        last = f"/{BLOCKS - 1}\n"
        while not heard.read_text().endswith(last) and time.monotonic() < end:
            service.look(), subscriber.look()
            time.sleep(0.1)
        for victim in victims:
            victim.end()
    with sqlite3.connect(state / "data_acquisition.db") as journal:
        got = numbers(journal.execute("SELECT message_id FROM inputs WHERE topic = 'raw_samples' ORDER BY receipt"))
        made = numbers(journal.execute("SELECT message_id FROM outputs WHERE topic = 'sample_block' ORDER BY ordinal"))
    everything = list(range(BLOCKS))
    check(sorted(got) == everything, f"{name}: {len(got)} blocks journaled, {len(set(got))} of {BLOCKS} different ones")
    check(got == everything, f"{name}: out of order")
    check(made == everything, f"{name}: {len(made)} blocks passed on")
    seen = numbers([(line,) for line in heard.read_text().split()])
    # Killed between hearing a message and noting it, the subscriber hears it again: that one at most.
    again = sum(late <= early for early, late in zip(seen, seen[1:]))
    check(again <= kills and all(late >= early for early, late in zip(seen, seen[1:])), f"{name}: heard backwards")
    check(seen and seen[-1] == BLOCKS - 1, f"{name}: the subscriber did not hear the last block")
    print(f"{name}: {BLOCKS} blocks, {kills} kills: each journaled once, in order; {len(set(seen))} heard, {again} again")


def main():
    choose = random.Random(SEED)
    senders = {"sender.py": [sys.executable, SOURCE / "docs/examples/sender_python/sender.py", ASSET, "R-1", BLOCKS,
                             SOURCE / "config"],
               "sender (C++)": [CPP_SENDER, ASSET, "R-1", BLOCKS]}
    for name, command in senders.items():
        with tempfile.TemporaryDirectory(prefix="sealwatch-senders-") as folder:
            run(name, command, pathlib.Path(folder), choose)


ENVIRONMENT = environment()
main()
