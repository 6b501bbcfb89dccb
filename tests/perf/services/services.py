"""Real service processes in a temporary state directory and a DDS discovery tag of their own, and what they cost."""
import os
import pathlib
import shutil
import signal
import subprocess
import tempfile
import time

SOURCE = pathlib.Path(__file__).resolve().parents[3]
DOMAIN = 97  # of its own: what others multicast in domain 0 would be received here too
SERVICES = ["data-acquisition", "data-manipulation", "state-detection", "health-assessment", "prognostic-assessment",
            "advisory-generation"]


class Services:
    """with Services(bin_directory, config, names) as services: ..."""

    def __init__(self, binaries, config=SOURCE / "config", names=SERVICES, stderr=None):
        self.binaries = pathlib.Path(binaries)
        self.config, self.names = config, names
        self.stderr, self.processes = stderr, {}

    def __enter__(self):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="sealwatch-perf-"))
        self.state = self.folder / "state"
        self.environment = dict(os.environ, CYCLONEDDS_URI=uri(f"perf-{os.getpid()}-{time.monotonic_ns()}"))
        for name in self.names:
            self.processes[name] = self.start([self.binaries / f"sealwatch-{name}", "--config", self.config,
                                               "--state", self.state, "--domain", DOMAIN], stderr=self.stderr)
        return self

    def start(self, command, **options):
        return subprocess.Popen([str(word) for word in command], env=self.environment, **options)

    def __exit__(self, *_):
        for process in self.processes.values():
            process.send_signal(signal.SIGTERM)
        for process in self.processes.values():
            process.wait(20)
        shutil.rmtree(self.folder)

    def cpu_s(self):
        """Processor time that each service has used."""
        return {name: cpu_s(process.pid) for name, process in self.processes.items()}


def uri(tag):
    return ('<CycloneDDS><Domain Id="any"><General><Interfaces><NetworkInterface name="lo" multicast="true"/></Interfaces>'
            f'</General><Discovery><LeaseDuration>2s</LeaseDuration><Tag>{tag}</Tag></Discovery></Domain></CycloneDDS>')


def cpu_s(process):
    """User and system time in seconds, from the scheduler's own count (nanoseconds) of every thread."""
    threads = pathlib.Path(f"/proc/{process}/task").glob("*/schedstat")
    return 1e-9 * sum(int(thread.read_text().split()[0]) for thread in threads)


def memory_MB(process, key):
    """Resident memory: key "VmRSS" all of it, "RssAnon" what is not shared with other processes."""
    for line in pathlib.Path(f"/proc/{process}/status").read_text().splitlines():
        if line.startswith(key + ":"):
            return int(line.split()[1]) * 1024e-6
    raise KeyError(key)


def load():
    """What else runs on this machine distorts figures."""
    return f"{os.cpu_count()} cores, load before the run {os.getloadavg()[0]:.1f}"


def median(values):
    values = sorted(values)
    return values[len(values) // 2]


def quantile(values, share):
    values = sorted(values)
    return values[min(len(values) - 1, int(share * len(values)))]
