#!/usr/bin/env python3
"""client.py PORT: loads the program of a motion controller on a TCP port, starts it, records all channels for 0.5 s,
stops, and prints a summary. Exit status 0: everything was as expected. It follows docs/link.md."""
import socket, sys, time, zlib

STATES = "idle homing run stop parked fault".split()
REFUSALS = """Unreadable Version ControlTaken NoControl NotArmed EnableOpen StopActive State OutOfRange Offset
    NotWriting TooLong FileCrc Rejected NotStored Busy Locked NotHomed ProgramRuns Jogs""".split()
IDENTIFY, READ, BEGIN, WRITE, FINISH, CONTROL, ARM, START, STOP, STREAM = 0, 1, 2, 3, 4, 6, 7, 9, 10, 19
VERSION, PROGRAM, TAKE, AT_PHASE, CHANNELS = 2, 1, 0, 0, 2047

def varint(n):
    return bytes([n]) if n < 128 else bytes([n & 127 | 128]) + varint(n >> 7)

def cobs(data):
    parts = [part[i:i + 254] for part in data.split(b"\0") for i in range(0, len(part) + 1, 254)]
    return b"".join(bytes([len(part) + 1]) + part for part in parts)

def uncobs(data):
    out = b""
    while data:
        code, part, data = data[0], data[1:data[0]], data[data[0]:]
        out += part + (b"\0" if code < 255 and data else b"")
    return out

class Reader:
    def __init__(self, data):
        self.rest = data
    def take(self, n):
        taken, self.rest = self.rest[:n], self.rest[n:]
        return taken
    def int(self):
        byte = self.take(1)[0]
        return byte if byte < 128 else byte & 127 | self.int() << 7
    def bytes(self):
        return self.take(self.int())

class Client:
    def __init__(self, port):
        self.end, self.line = time.monotonic() + 60, socket.create_connection(("127.0.0.1", port), 60)
        self.sent = self.damaged = self.samples = self.gaps = self.axes = self.speed = self.expected = 0
        self.received, self.reply, self.next_tick, self.state, self.states, self.steps = b"", None, None, None, [], []

    def request(self, *fields):
        """Sends integers and bytes; returns a reader of the reply's body. All integers here are u16 or u32."""
        body = b"".join(varint(f) if isinstance(f, int) else varint(len(f)) + f for f in fields)
        body, self.reply = self.sent.to_bytes(2, "little") + body, None
        self.line.sendall(cobs(body + zlib.crc32(body).to_bytes(4, "little")) + b"\0")
        self.wait(lambda: self.reply, f"the reply to request {fields[0]}")
        self.sent += 1
        refused, variant = self.reply.int(), self.reply.int()
        if refused:
            sys.exit(f"request {fields[0]} was refused: {REFUSALS[variant]} {self.reply.rest}")
        return self.reply

    def wait(self, condition, what):
        while not condition():
            if time.monotonic() > self.end:
                sys.exit(f"waited in vain for {what}, in state {self.state}")
            self.line.settimeout(max(0.01, self.end - time.monotonic()))
            try:
                data = self.line.recv(65536) or sys.exit("the controller closed the line")
            except TimeoutError:
                continue
            *frames, self.received = (self.received + data).split(b"\0")
            for frame in map(uncobs, frames):
                if zlib.crc32(frame[:-4]).to_bytes(4, "little") == frame[-4:]:
                    self.message(int.from_bytes(frame[:2], "little"), Reader(frame[2:-4]))
                else:
                    self.damaged += 1

    def message(self, number, fields):
        self.damaged += number != self.expected  # a frame is missing
        self.expected = number + 1 & 0xFFFF
        kind = fields.int()
        if kind == 0 and fields.int() == self.sent:
            self.reply = fields
        elif kind == 2:
            self.packet(fields.int(), fields.int(), fields.int(), fields.take(1)[0], Reader(fields.bytes()))

    def packet(self, tick, every, channels, count, packet):
        self.gaps += tick != self.next_tick is not None
        self.next_tick = tick + every * count & 0xFFFFFFFF
        # state, program, amax, speed, acceleration, phase; lead, steps, phase error and correction by axis; 4 modes
        values = [0] * (6 + 4 * self.axes + 4)
        for _ in range(count):
            for i in range(len(values)):
                d = packet.int()
                values[i] = (values[i] + (d >> 1 ^ -(d & 1)) + 2**63) % 2**64 - 2**63
            self.state = STATES[values[0] & 255]
            self.states += [self.state] if self.state not in self.states else []
            self.speed = max(self.speed, abs(values[3]))
            self.steps = values[6 + self.axes:6 + 2 * self.axes]
        self.samples += count
        self.damaged += channels != CHANNELS or len(packet.rest) > 0

    def read(self, file):
        data, chunk = b"", None
        while chunk != b"":
            reply = self.request(READ, file, len(data))
            reply.int()  # the length of the file
            chunk = reply.bytes()
            data += chunk
        return data

def main():
    client = Client(int(sys.argv[1]))
    identity = client.request(IDENTIFY, VERSION)
    _version, board, _serial, firmware = identity.int(), identity.bytes(), identity.int(), identity.bytes()
    _settings, _settings_crc, _program_crc = identity.bytes(), identity.int(), identity.int()
    client.axes, hz = identity.take(1)[0], identity.int()
    print(f"board {board.decode()}, firmware {firmware.decode()}, {client.axes} axes, {hz} ticks a second")
    client.request(CONTROL, TAKE)
    program = client.read(PROGRAM)
    client.request(BEGIN, PROGRAM, len(program), zlib.crc32(program))
    for at in range(0, len(program), 384):
        client.request(WRITE, at, program[at:at + 384])
    client.request(FINISH)
    is_same = client.read(PROGRAM) == program
    print(f"program of {len(program)} bytes is {'the same' if is_same else 'not the same'} when read again")
    client.request(STREAM, CHANNELS, 1)
    client.wait(lambda: client.samples, "the first sample")
    client.request(ARM)
    client.request(START)
    client.wait(lambda: client.state == "run", "run")
    enough = client.samples + hz // 2
    client.wait(lambda: client.samples >= enough, "0.5 s of samples")
    client.request(STOP, AT_PHASE)
    client.wait(lambda: client.state == "parked", "parked")
    print(f"{client.samples} samples, {client.gaps} gaps, {client.damaged} damaged, states {' '.join(client.states)}, "
          f"steps {client.steps}, at most {client.speed / 2**48 * hz:.3f} turns/s")
    equal = len(set(client.steps)) == 1
    return 0 if is_same and equal and {"homing", "run", "parked"} <= set(client.states) \
        and not client.gaps and not client.damaged else 1

if __name__ == "__main__":
    sys.exit(main())
