#!/usr/bin/python3
"""modbus_peer.py tcp PORT... | rtu LINK...: Modbus modules on Debian's pymodbus, one a line, which fail in every way that is asked for.

A tcp line listens on its port of 127.0.0.1 (0: any); an rtu line is a pseudo terminal that its link names. `ready PORT...` is printed once
all are there. Then every line on the standard input is a command and gets one line as its answer. L is the number of a line, from 0; T a
table: c coils, d discrete inputs, h holding registers, i input registers.

Every line has a second module, unit 2; L.2 is that. The faults below are the first one's, but for those of the tables and `dead`.

  get L T FIRST COUNT         what stands there                     set L T FIRST VALUE...      somebody at the module sets it
  served L                    how many requests were answered       unit L N                    it has this address from now on (at first 1)
  watchdog L MS FIRST BITS    unless register 100 is written every MS, the coils from FIRST on become BITS; 0: no watchdog
  armed L                     whether the watchdog may yet strike   reset L                     as at the start
  fed L                       the first three values that register 100 was given, "-" for none
  cut L / mend L              the line itself                       mute L 0|1                  it does what is asked and says nothing
  late L MS                   answers come so late                  exception L CODE            nothing but this is answered; 0: ends
  dead L                      it never answers again                asked L                     how often it was asked something
  noise L 0|1                 bytes of nobody on an rtu line        stuck L COIL                it stays as it is
  refuse L 0|1                it answers every write with exception 4
  stood L                     the longest time in ms that the whole program stood still, since this was asked last

Every write of coils that it obeyed, and every strike of a watchdog, is added to the file that JOURNAL in the environment names: `L write
BITS`, `L struck BITS`, with all coils as they are then; for a second module 100 + L.
"""
import asyncio
import logging
import os
import pty
import random
import signal
import sys
import time
import tty

from pymodbus.datastore import ModbusSequentialDataBlock, ModbusServerContext, ModbusSlaveContext
from pymodbus.server.async_io import ModbusConnectedRequestHandler, ModbusSingleRequestHandler, ModbusTcpServer
from pymodbus.transaction import ModbusRtuFramer, ModbusSocketFramer

SIZE = 128
WRITES = (5, 6, 15, 16)
WATCHDOG_REGISTER = 100
TICK_MS = 3
SILENCE = 0.02  # seconds after which a frame on a serial line is over; generous, since this is no real-time program
logging.disable(logging.ERROR)  # what it does not understand is what tests are about
JOURNAL = os.environ.get("JOURNAL")


class Module(ModbusSlaveContext):
    def __init__(self, number):
        blocks = {key: ModbusSequentialDataBlock(0, [0] * SIZE) for key in ("co", "di", "hr", "ir")}
        super().__init__(zero_mode=True, **blocks)
        self.number = number
        self.watchdog_ms, self.safe_first, self.safe_bits = 0, 0, []
        self.fed_at = None  # not since the last strike
        self.fed = []
        self.stuck = None
        self.dead, self.asked = False, 0

    def note(self, what):
        if JOURNAL:
            bits = "".join(str(int(bit)) for bit in self.store["c"].getValues(0, SIZE))
            with open(JOURNAL, "a", encoding="ascii") as journal:
                journal.write(f"{self.number} {what} {bits}\n")

    def setValues(self, fc_as_hex, address, values):
        table = self.decode(fc_as_hex)
        if table == "c" and self.stuck is not None and address <= self.stuck < address + len(values):
            values = list(values)
            values[self.stuck - address] = self.store["c"].getValues(self.stuck, 1)[0]
        super().setValues(fc_as_hex, address, values)
        if table == "c":
            self.note("write")
        if table == "h" and address <= WATCHDOG_REGISTER < address + len(values):
            self.fed_at = time.monotonic()
            self.fed = (self.fed + [values[WATCHDOG_REGISTER - address]])[:3]

    def watch(self):
        if not self.watchdog_ms or self.fed_at is None or time.monotonic() - self.fed_at < self.watchdog_ms / 1000:
            return
        self.fed_at = None
        self.store["c"].setValues(self.safe_first, self.safe_bits)
        self.note("struck")


class Addresses(ModbusServerContext):
    """Two modules. Whoever holds slaves() sees a change of the first one's address at once: pymodbus asks before it waits for a request."""

    def __init__(self, first, second):
        super().__init__(slaves={1: first, 2: second}, single=False)
        self.units = [1, 2]

    def slaves(self):
        return self.units

    def move(self, unit):
        self._slaves[unit] = self._slaves.pop(self.units[0])
        self.units[0] = unit


class Faults:
    """Stands before a request handler of pymodbus: what the line has between a request and its answer."""

    def execute(self, request, *addr):
        line = self.server.line
        if request.unit_id not in self.server.context:
            return
        module = self.server.context[request.unit_id]
        module.asked += 1
        if module.dead:
            return
        if line.exception or line.refuse and request.function_code in WRITES:
            answer = request.doException(line.exception or 4)
            answer.transaction_id, answer.unit_id = request.transaction_id, request.unit_id
            self.send(answer, *addr)
            return
        super().execute(request, *addr)
        line.served += 1

    def _send_(self, data):
        line = self.server.line
        if line.mute:
            return
        if line.late_ms:
            asyncio.get_event_loop().call_later(line.late_ms / 1000, super()._send_, data)
        else:
            super()._send_(data)


class TcpHandler(Faults, ModbusConnectedRequestHandler):
    pass


class RtuHandler(Faults, ModbusSingleRequestHandler):
    pass


class Terminal:
    """The module's end of a pseudo terminal; the other end is held open, so that it stays when its user goes."""

    def __init__(self, line, link):
        self.line = line
        self.module_end, self.user_end = pty.openpty()
        tty.setraw(self.user_end)
        os.set_blocking(self.module_end, False)
        os.symlink(os.ttyname(self.user_end), link)
        self.last_byte_at = 0
        self.handler = RtuHandler(line.server)
        self.handler.connection_made(self)
        asyncio.get_event_loop().add_reader(self.module_end, self.readable)

    def readable(self):
        data = os.read(self.module_end, 4096)
        now = time.monotonic()
        if now - self.last_byte_at > SILENCE:
            self.handler.framer.resetFrame()
        self.last_byte_at = now
        self.handler.data_received(data)

    def get_extra_info(self, name):
        return None

    def write(self, data):
        if self.module_end is None:
            return
        try:
            os.write(self.module_end, data)
        except BlockingIOError:
            pass  # nobody reads: a wire keeps nothing

    def close(self):
        asyncio.get_event_loop().remove_reader(self.module_end)
        self.handler.connection_lost(None)
        os.close(self.module_end)
        os.close(self.user_end)
        self.module_end = None


class Line:
    def __init__(self, number, kind, where):
        self.number, self.kind, self.where = number, kind, where
        self.listener = self.terminal = None
        self.woken, self.stood_ms = time.monotonic(), 0
        self.reset()

    def reset(self):
        self.mute, self.late_ms, self.exception, self.refuse, self.noise, self.served = 0, 0, 0, 0, 0, 0
        self.module, self.second = Module(self.number), Module(100 + self.number)
        context = Addresses(self.module, self.second)
        if self.kind == "tcp":
            self.server = ModbusTcpServer(context, ModbusSocketFramer, handler=TcpHandler, ignore_missing_slaves=True)
        else:
            self.server = ModbusTcpServer(context, ModbusRtuFramer, handler=RtuHandler, ignore_missing_slaves=True)
        self.server.line = self

    async def mend(self):
        if self.kind == "rtu":
            self.terminal = Terminal(self, self.where)
            return
        loop = asyncio.get_event_loop()
        server = self.server
        # Not of the ports that the kernel gives to who connects: one that connects again and again
        # to such a port while nobody listens is sooner or later connected to itself.
        for port in [self.where] if self.where else range(20000 + os.getpid() % 10000, 32000):
            try:
                self.listener = await loop.create_server(lambda: TcpHandler(server), "127.0.0.1", port, reuse_address=True)
            except OSError:
                continue
            self.where = port
            return
        sys.exit("no free port")

    async def cut(self):
        if self.kind == "rtu":
            os.unlink(self.where)  # first: the number of a terminal that is gone is soon another program's
            self.terminal.close()
            self.terminal = None
            return
        self.listener.close()
        self.listener = None
        # Who was let in just now is among the connections some rounds of the loop later.
        for _ in range(10):
            await asyncio.sleep(0)
        for handler in list(self.server.active_connections.values()):
            handler.transport.abort()

    def wake(self):
        last, self.woken = self.woken, time.monotonic()
        self.stood_ms = max(self.stood_ms, 1000 * (self.woken - last) - TICK_MS)

    def is_cut(self):
        return self.listener is None and self.terminal is None


async def obey(lines, words):
    command, (number, _, second) = words[0], words[1].partition(".")
    line = lines[int(number)]
    module = line.second if second else line.module
    values = [int(word) for word in words[3:]] if command in ("get", "set") else []
    if command == "get":
        return " ".join(str(int(value)) for value in module.store[words[2]].getValues(values[0], values[1]))
    if command == "set":
        module.store[words[2]].setValues(values[0], values[1:])
    elif command == "served":
        return str(line.served)
    elif command == "armed":
        return str(int(bool(line.module.watchdog_ms) and line.module.fed_at is not None))
    elif command == "fed":
        return " ".join(map(str, module.fed)) or "-"
    elif command == "unit":
        line.server.context.move(int(words[2]))
    elif command == "watchdog":
        line.module.watchdog_ms, line.module.safe_first = int(words[2]), int(words[3])
        line.module.safe_bits = [int(bit) for bit in words[4]]
    elif command == "dead":
        module.dead = True
    elif command == "asked":
        return str(module.asked)
    elif command == "stuck":
        module.stuck = int(words[2])
    elif command == "cut":
        await line.cut()
    elif command == "mend":
        await line.mend()
    elif command == "reset":
        if not line.is_cut():
            await line.cut()
        line.reset()
        await line.mend()
    elif command in ("mute", "noise", "exception", "refuse"):
        setattr(line, command, int(words[2]))
    elif command == "late":
        line.late_ms = int(words[2])
    elif command == "stood":
        line.wake()
        stood_ms, line.stood_ms = line.stood_ms, 0
        return str(round(stood_ms))
    else:
        return "no such command"
    return "ok"


async def main():
    kind, places = sys.argv[1], sys.argv[2:]
    lines = [Line(number, kind, int(place) if kind == "tcp" else place) for number, place in enumerate(places)]
    for line in lines:
        await line.mend()
    print("ready", *(line.where for line in lines), flush=True)
    commands = asyncio.StreamReader()
    await asyncio.get_event_loop().connect_read_pipe(lambda: asyncio.StreamReaderProtocol(commands), sys.stdin)

    async def live():
        chance = random.Random(1)
        while True:
            for line in lines:
                line.wake()
                line.module.watch()
                if line.noise and line.terminal:
                    line.terminal.write(chance.randbytes(chance.randint(1, 9)))
            await asyncio.sleep(TICK_MS / 1000)

    living = asyncio.create_task(live())
    while words := (await commands.readline()).decode().split():
        print(await obey(lines, words), flush=True)
    living.cancel()


signal.signal(signal.SIGINT, signal.SIG_IGN)  # for who started it to decide
asyncio.run(main())
