#!/usr/bin/python3
"""Sends one test so that it arrives once whatever is killed on the way: this program, `sealwatch publish`, the services.

Each block has an id that is the same whenever it is sent, and is sent again until it is confirmed. Start this program
again after a kill; what had arrived is known by its id.
Usage: sender.py ASSET_ID RECORDING_ID BLOCKS [CONFIG]. Prints the id of each block once data_acquisition has it.
"""
import json
import subprocess
import sys
import threading


def block(asset, recording, number, blocks):
    """One second at 200 Hz. A real one comes from a store of its own, where it stays until it is confirmed."""
    time_s = [number + k / 200 for k in range(200)]
    boundary = "begin" if number == 0 else "end" if number == blocks - 1 else "inside"
    return {"header": {"message_id": f"raw_samples/{asset}/{recording}/{number}"}, "asset_id": asset,
            "source_id": "sender.py", "recording_id": recording, "block_number": number, "boundary": boundary,
            "samples": {"time_s": time_s, "channels": [
                {"name": "position", "unit": "m", "values": [0.060 - 1.33e-3 * t for t in time_s]}]}}


def write(stream, lines):
    try:
        for line in lines:
            print(line, file=stream)
        stream.close()
    except BrokenPipeError:
        pass  # it was killed: again with what is left


def send(unconfirmed, config):
    """One life of `sealwatch publish`: what it confirms leaves `unconfirmed`."""
    command = ["sealwatch", "publish"] + (["--config", config] if config else [])
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as publish:
        lines = [json.dumps({"topic": "raw_samples", "message": message}) for message in unconfirmed.values()]
        writer = threading.Thread(target=write, args=(publish.stdin, lines))  # it reads no further than it can send
        writer.start()
        for line in publish.stdout:
            confirmed = json.loads(line)["confirmed"]
            if unconfirmed.pop(confirmed, None):
                print(confirmed, flush=True)
        writer.join()
    if publish.returncode == 2:
        sys.exit(2)  # a line was refused: sending it again would not help


def main():
    if len(sys.argv) not in (4, 5):
        sys.exit(__doc__)
    asset, recording, blocks = sys.argv[1], sys.argv[2], int(sys.argv[3])
    messages = [block(asset, recording, number, blocks) for number in range(blocks)]
    unconfirmed = {message["header"]["message_id"]: message for message in messages}
    while unconfirmed:
        send(unconfirmed, sys.argv[4] if len(sys.argv) == 5 else None)


main()
