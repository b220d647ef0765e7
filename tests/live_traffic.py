"""Traffic for the live loop, seen from outside: `send PORT COUNT RATE` and `receive PORT COUNT IDLE_S`.

The sender notes when each sample left, the receiver the kernel's stamp of each answer; both on the system's clock.
"""

import socket
import struct
import sys
import time

import numpy as np

STAMP = 35  # SO_TIMESTAMPNS


def send(port: int, count: int, rate_hz: float) -> None:
    out = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    left = np.zeros(count, np.int64)
    begin = time.monotonic()
    for index in range(count):
        wait = begin + index / rate_hz - time.monotonic()
        if wait > 0:
            time.sleep(wait)
        line = f"{index},{index % 17 * 0.01}".encode()
        left[index] = time.time_ns()
        out.sendto(line, ("127.0.0.1", port))
    sys.stdout.buffer.write(left.tobytes())


def receive(port: int, count: int, idle_s: float) -> None:
    incoming = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    incoming.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 1 << 22)
    if sys.platform == "linux":
        incoming.setsockopt(socket.SOL_SOCKET, STAMP, 1)
    incoming.bind(("127.0.0.1", port))
    incoming.settimeout(idle_s)
    print(incoming.getsockname()[1], flush=True)
    came = np.zeros(count, np.int64)
    for _ in range(count):
        try:
            data, extra, _, _ = incoming.recvmsg(4096, 64)
        except TimeoutError:
            break
        stamps = [struct.unpack("qq", d) for _, kind, d in extra if kind == STAMP and len(d) == 16]
        came[int(data.split(b",")[0])] = stamps[0][0] * 10**9 + stamps[0][1] if stamps else time.time_ns()
    sys.stdout.buffer.write(came.tobytes())


if __name__ == "__main__":
    if sys.argv[1] == "send":
        send(int(sys.argv[2]), int(sys.argv[3]), float(sys.argv[4]))
    else:
        receive(int(sys.argv[2]), int(sys.argv[3]), float(sys.argv[4]))
