"""Both clients against a daemon that returns each request: names, ids, time-outs, interrupts."""

import ast
import asyncio
import ctypes
import json
import os
import pathlib
import random
import signal
import threading
import unittest

from fake_daemon import FakeDaemon
from sculptd.control import AsyncClient, Client, DaemonAbsent, DaemonRefused, DaemonSilent

PYTHON = pathlib.Path(__file__).resolve().parents[1]
SCHEMA = json.loads((PYTHON.parents[1] / "control/schema.json").read_text(encoding="utf-8"))
LONG = bool(os.environ.get("SCULPTD_LONG"))
#: Parameters that the client's own methods ask for.
GIVEN = {"stroke": ([[0.5, 0.5, 0.8, 0]],), "export": ("/a.stl",), "load": ("/a.stl",)}


def typed_methods(client):
    """The dotted names of the methods that the stub gives a client."""
    tree = ast.parse((PYTHON / "python/sculptd/control.pyi").read_text(encoding="utf-8"))
    classes = {c.name: c.body for c in tree.body if isinstance(c, ast.ClassDef)}
    functions = (ast.FunctionDef, ast.AsyncFunctionDef)
    for f in (f for f in classes[client] if isinstance(f, functions)):
        if not f.decorator_list:
            yield f.name
            continue
        for inner in (g for g in classes[f.returns.id] if isinstance(g, functions)):
            yield f.name if inner.name == "__call__" else f"{f.name}.{inner.name}"


def find(client, name):
    for part in name.split("."):
        client = getattr(client, part)
    return client


class Names(unittest.TestCase):
    def test_every_method_of_the_schema_is_called_through_its_typed_method(self):
        for client in ("Client", "AsyncClient"):
            typed = {n.replace("_", "-"): n for n in typed_methods(client)}
            self.assertEqual(set(SCHEMA["methods"]) - set(typed), set())
        with FakeDaemon() as daemon, Client(daemon.path) as client:
            for name in SCHEMA["methods"]:
                reply = find(client, typed[name])(*GIVEN.get(name, ()))
                self.assertEqual(reply["method"], name)

        async def all_at_once():
            async with AsyncClient(daemon.path) as client:
                calls = [find(client, typed[n])(*GIVEN.get(n, ())) for n in SCHEMA["methods"]]
                return [reply["method"] for reply in await asyncio.gather(*calls)]

        with FakeDaemon() as daemon:
            self.assertEqual(asyncio.run(all_at_once()), list(SCHEMA["methods"]))


class Starting(unittest.TestCase):
    def test_clients_wait_for_a_daemon_that_comes_up(self):
        async def ask(path):
            async with AsyncClient(path, wait=20.0) as client:
                return await client.call("late", {"n": 2})

        with FakeDaemon() as daemon:
            away = daemon.path + ".away"

            def late():
                os.rename(daemon.path, away)
                threading.Timer(0.2, os.rename, (away, daemon.path)).start()

            late()
            with Client(daemon.path, wait=20.0) as client:
                self.assertEqual(client.call("late", {"n": 1})["params"], {"n": 1})
                # After a loss too.
                late()
                daemon.drop()
                with self.assertRaises(DaemonSilent):
                    client.call("lost")
                self.assertEqual(client.call("late", {"n": 3})["params"], {"n": 3})
            late()
            self.assertEqual(asyncio.run(ask(daemon.path))["params"], {"n": 2})


class Answers(unittest.TestCase):
    def test_an_answer_that_came_too_late_is_passed_over(self):
        with FakeDaemon(delay=0.02) as daemon, Client(daemon.path) as client:
            for n in range(30):
                try:
                    client.call("late", {"n": -n}, patience=0.001)
                except DaemonSilent:
                    pass
                self.assertEqual(client.call("echo", {"n": n})["params"], {"n": n})
            self.assertEqual(len(daemon.connections), 1, "a time-out needs no new connection")

    def test_a_lost_connection_is_made_again_and_events_go_on(self):
        with FakeDaemon() as daemon, Client(daemon.path) as client:
            client.subscribe()
            self.assertEqual(client.next_event(5.0)["event"], "work")
            daemon.drop()
            with self.assertRaises(DaemonSilent):
                client.status()
            self.assertEqual(client.status()["method"], "status")
            self.assertEqual(client.next_event(5.0)["event"], "work")
            with self.assertRaises(DaemonRefused):
                client.frobnicate()

    def test_no_answer_is_swapped_between_threads_with_time_outs_and_interrupts(self):
        """Eight threads share a client. The first is interrupted by Ctrl-C, the others by the same
        exception of another thread."""
        total, swapped, right, stopped = (10_000 if LONG else 1_000), [], [], threading.Event()
        interrupts = [0]

        def work(client, thread):
            chance, n = random.Random(thread), 0
            while n < total // 8:
                try:
                    while n < total // 8:
                        n += 1
                        asked = [thread, n]
                        patience = chance.choice([0.0002, 0.001, 30.0, 30.0])
                        try:
                            reply = client.call("echo", {"asked": asked}, patience=patience)
                        except (DaemonSilent, DaemonAbsent):
                            continue
                        (right if reply["params"]["asked"] == asked else swapped).append(asked)
                except KeyboardInterrupt:
                    interrupts[0] += 1

        def interrupt(threads):
            chance = random.Random(0)
            while not stopped.wait(chance.random() * 0.01):
                thread = chance.choice([None, *threads])
                if thread is None:
                    os.kill(os.getpid(), signal.SIGINT)
                elif thread.is_alive():
                    ident = ctypes.c_ulong(thread.ident)
                    error = ctypes.py_object(KeyboardInterrupt)
                    ctypes.pythonapi.PyThreadState_SetAsyncExc(ident, error)

        with FakeDaemon(delay=0.002) as daemon, Client(daemon.path) as client:
            threads = [threading.Thread(target=quiet(work), args=(client, t)) for t in range(1, 8)]
            for thread in threads:
                thread.start()
            killer = threading.Thread(target=interrupt, args=(threads,))
            killer.start()
            while True:
                try:
                    work(client, 0)
                    stopped.set()
                    break
                except KeyboardInterrupt:
                    continue
            finish(killer, *threads)
            self.assertEqual(client.call("echo", {"asked": 0})["params"]["asked"], 0)
        print(f"{total} requests: {len(right)} answered, {interrupts[0]} interrupts, "
              f"{len(daemon.connections)} connections, {len(swapped)} swapped")
        self.assertEqual(swapped, [])
        self.assertGreater(len(right), total // 4)
        self.assertGreater(interrupts[0], 5)


def quiet(work):
    """The same without a report of an interrupt that comes at its very end."""

    def run(*arguments):
        try:
            work(*arguments)
        except KeyboardInterrupt:
            pass

    return run


def finish(*threads):
    """Waits for threads, whatever interrupts still come."""
    for thread in threads:
        while thread.is_alive():
            try:
                thread.join(0.1)
            except KeyboardInterrupt:
                pass


class Asynchronous(unittest.IsolatedAsyncioTestCase):
    async def test_cancelled_tasks_leave_the_answers_of_the_others(self):
        total, chance = (10_000 if LONG else 1_000), random.Random(2)

        async def one(client, n):
            patience = chance.choice([0.0005, 60.0, 60.0])
            return (await client.call("echo", {"n": n}, patience=patience))["params"]["n"]

        with FakeDaemon(delay=0.001) as daemon:
            async with AsyncClient(daemon.path) as client:
                right = lost = 0
                for start in range(0, total, 50):
                    tasks = [asyncio.create_task(one(client, start + k)) for k in range(50)]
                    await asyncio.sleep(chance.random() * 0.01)
                    for task in chance.sample(tasks, 10):
                        task.cancel()
                    answers = await asyncio.gather(*tasks, return_exceptions=True)
                    for k, answer in enumerate(answers):
                        if isinstance(answer, BaseException):
                            self.assertIsInstance(answer, (DaemonSilent, asyncio.CancelledError))
                            lost += 1
                        else:
                            self.assertEqual(answer, start + k)
                            right += 1
                self.assertGreater(right, total // 4)
                self.assertGreater(lost, total // 20)
                self.assertEqual(client._waiting, {})

    async def test_events_are_iterated(self):
        with FakeDaemon() as daemon:
            async with AsyncClient(daemon.path) as client:
                await client.subscribe()
                seen = [event["event"] async for event in client.events(patience=0.2)]
                self.assertEqual(seen, ["work"])
                with self.assertRaises(DaemonRefused):
                    await client.frobnicate()

    async def test_a_lost_connection_is_made_again_and_events_go_on(self):
        with FakeDaemon(delay=0.2) as daemon:
            async with AsyncClient(daemon.path) as client:
                await client.subscribe()
                await client.next_event(5.0)
                asking = asyncio.create_task(client.status())
                await asyncio.sleep(0.01)
                daemon.drop()
                with self.assertRaises(DaemonSilent):
                    await asking
                self.assertEqual((await client.status())["method"], "status")
                self.assertEqual((await client.next_event(5.0))["event"], "work")

    async def test_no_daemon_is_an_error_with_the_path(self):
        with self.assertRaises(DaemonAbsent):
            async with AsyncClient("/nowhere/sculptd.sock"):
                pass


if __name__ == "__main__":
    unittest.main()
