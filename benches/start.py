"""Start to the first screen, and what an idle face costs, on a pseudo-terminal: python3 benches/start.py [RUNS]

Wants target/release/poescope (cargo build --release) and nothing but Python. The first screen has the experts' table and
the recorded frame on it; the terminal here answers no query, as over a plain serial line.
"""

import os
import pty
import select
import statistics
import sys
import time

PROGRAM = os.path.join(os.path.dirname(__file__), "..", "target", "release", "poescope")
IDLE_SECS = 5


def spawn():
    pid, terminal = pty.fork()
    if pid == 0:
        os.environ.update(TERM="xterm-256color", COLORTERM="truecolor", COLUMNS="120", LINES="40")
        os.execv(PROGRAM, [PROGRAM, *sys.argv[2:]])
    # 40 rows, 120 columns.
    import fcntl, struct, termios

    fcntl.ioctl(terminal, termios.TIOCSWINSZ, struct.pack("HHHH", 40, 120, 0, 0))
    return pid, terminal


def read(terminal, secs):
    """What comes within so many seconds of silence."""
    ready, _, _ = select.select([terminal], [], [], secs)
    if not ready:
        return b""
    try:
        return os.read(terminal, 1 << 16)
    except OSError:
        return b""


def ticks(pid):
    with open(f"/proc/{pid}/stat", encoding="ascii") as stat:
        fields = stat.read().rsplit(")", 1)[1].split()
    return int(fields[11]) + int(fields[12])


def end(pid, terminal):
    os.write(terminal, b"q")
    while read(terminal, 1.0):
        pass
    os.waitpid(pid, 0)
    os.close(terminal)


def first_screens(wanted):
    start = time.perf_counter()
    pid, terminal = spawn()
    seen, screen, belief = b"", None, None
    while belief is None and time.perf_counter() - start < 20:
        seen += read(terminal, 20)
        now = time.perf_counter() - start
        if screen is None and b"step" in seen and "▀".encode() in seen:
            screen = now
        if wanted in seen:
            belief = now
    end(pid, terminal)
    return screen * 1e3, belief * 1e3


def idle():
    pid, terminal = spawn()
    while read(terminal, 2.0):
        pass
    before, count = ticks(pid), 0
    deadline = time.perf_counter() + IDLE_SECS
    while time.perf_counter() < deadline:
        count += len(read(terminal, deadline - time.perf_counter()))
    used = ticks(pid) - before
    end(pid, terminal)
    return used, count


def main():
    runs = int(sys.argv[1]) if len(sys.argv) > 1 else 20
    # The mean share of an expert: there are beliefs.
    both = [first_screens(b"%") for _ in range(runs)]
    for name, values in zip(("first screen", "first beliefs"), zip(*both)):
        ordered = sorted(values)
        p95 = ordered[round(0.95 * (len(ordered) - 1))]
        print(f"start to {name}: p50 {statistics.median(values):.0f} ms, p95 {p95:.0f} ms ({runs} runs)")
    used, count = idle()
    print(f"idle for {IDLE_SECS} s: {used} CPU ticks of 10 ms, {count} bytes drawn")


if __name__ == "__main__":
    main()
