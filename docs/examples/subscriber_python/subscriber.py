#!/usr/bin/python3
"""Hears every new message of a topic once, and the latest of every asset first, whatever is killed on the way.

What makes it so: messages of one writer about one asset come with rising numbers, so one that is not higher than the
last is known; the numbers are kept in a file, after a message was handled. Killed in between it handles that message
again: let `handle` know it by its message_id.
Usage: subscriber.py TOPIC POSITIONS_FILE [CONFIG]. Prints the id of each message.
"""
import json
import os
import pathlib
import subprocess
import sys


def handle(message):
    print(message["header"]["message_id"], flush=True)


def is_new(message, positions):
    """Notes the message's number; one of outside has none and is always new."""
    header = message["header"]
    stream = header["writer_id"] + " " + message["asset_id"]
    if header["stream_sequence"] and header["stream_sequence"] <= positions.get(stream, 0):
        return False
    positions[stream] = header["stream_sequence"]
    return True


def save(positions, file):
    """Whole or not at all."""
    new = file.with_name(file.name + ".new")
    new.write_text(json.dumps(positions))
    os.replace(new, file)


def watch(topic, config, positions, file):
    """One life of `sealwatch watch`."""
    command = ["sealwatch", "watch", topic, "--json"] + (["--config", config] if config else [])
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
        for line in process.stdout:
            if not line.endswith("\n"):
                break  # it was killed while it wrote
            message = json.loads(line)["message"]
            if is_new(message, positions):
                handle(message)
                save(positions, file)
    return process.returncode


def main():
    if len(sys.argv) not in (3, 4):
        sys.exit(__doc__)
    topic, file = sys.argv[1], pathlib.Path(sys.argv[2])
    positions = json.loads(file.read_text()) if file.exists() else {}
    ended = -1
    while ended != 2:  # bad usage; all else may be over when it is started again
        ended = watch(topic, sys.argv[3] if len(sys.argv) == 4 else None, positions, file)
    sys.exit(2)


main()
