"""Many runs in one process, runs side by side, and runs that are ended."""

import os
import signal
import subprocess
import sys
import threading
import time
import unittest
import unittest.mock

import numpy as np
import stackmesh
from support import FolderTest, arrays_of, ball, same, testdata

LONG = """
import sys, time
import numpy as np
import stackmesh
i, j, k = np.indices((220, 220, 220))
labels = (((i - 110.) ** 2 + (j - 110.) ** 2 + (k - 110.) ** 2 < 100. ** 2) * (1 + (i + j + k) // 30 % 7)).astype(np.uint8)
def told(stage, done):
    if stage == sys.argv[1]:
        print("now", flush=True)
try:
    stackmesh.mesh(labels, output=sys.argv[2], progress=told, edge_length=2.0, yes=True)
except KeyboardInterrupt:
    print("interrupted", time.time(), flush=True)
print("end", flush=True)
"""


def memory_kb():
    with open("/proc/self/statm") as f:
        return int(f.read().split()[1]) * os.sysconf("SC_PAGE_SIZE") // 1024


def workers_of(pid):
    """Processes named stackmesh-tetgen (of which Linux keeps 15 letters) that say they are of that process."""
    found = []
    for name in os.listdir("/proc"):
        if not name.isdigit():
            continue
        try:
            with open(f"/proc/{name}/comm") as f:
                command = f.read().strip()
            with open(f"/proc/{name}/environ", "rb") as f:
                environ = f.read()
        except OSError:
            continue
        if command == "stackmesh-tetge" and f"STACKMESH_TETGEN_WORKER={pid}".encode() in environ.split(b"\0"):
            found.append(int(name))
    return found


class Memory(unittest.TestCase):
    def test_stays_flat_over_100_calls(self):
        labels = ball()
        at = []
        for _ in range(100):
            mesh = stackmesh.mesh(labels)
            mesh.points, mesh.tets  # views, too
            at.append(memory_kb())
        grown = np.median(at[90:]) - np.median(at[15:25])
        print(f"resident memory after 20 runs {at[20]} kB, after 100 runs {at[99]} kB", file=sys.stderr)
        self.assertLess(grown, 3000, f"kB over 75 calls; all: {at[::10]}")

    def test_of_refused_runs_stays_flat(self):
        labels = ball().astype(float)
        labels[5, 5, 5] = np.nan
        at = []
        for _ in range(200):
            with self.assertRaises(stackmesh.Error):
                stackmesh.mesh(labels)
            at.append(memory_kb())
        self.assertLess(np.median(at[180:]) - np.median(at[20:40]), 2000, str(at[::20]))

    def test_arrays_keep_their_mesh_and_copy_nothing(self):
        mesh = stackmesh.mesh(ball())
        points, labels = mesh.points, mesh.triangle_labels
        kept = points.copy(), labels.copy()
        self.assertEqual(points.ctypes.data, mesh.points.ctypes.data)
        self.assertFalse(points.flags.owndata or points.flags.writeable or labels.flags.owndata)
        with self.assertRaises(ValueError):
            points[0, 0] = 1
        del mesh
        for _ in range(3):
            stackmesh.mesh(ball())
        self.assertTrue((points == kept[0]).all() and (labels == kept[1]).all())


class SideBySide(unittest.TestCase):
    def test_two_threads_give_what_one_gives(self):
        inputs = [ball(), testdata("shells.nii.gz")]
        alone = [stackmesh.mesh(i) for i in inputs]
        made = {}

        def run(n):
            made[n] = stackmesh.mesh(inputs[n % 2])

        threads = [threading.Thread(target=run, args=(n,)) for n in range(4)]
        for t in threads:
            t.start()
        for t in threads:
            t.join()
        for n in range(4):
            self.assertTrue(same(made[n], alone[n % 2]))

    def test_python_goes_on_meanwhile(self):
        """The GIL is released: another thread counts on."""
        counts = [0]
        stop = threading.Event()

        def count():
            while not stop.is_set():
                counts[0] += 1
                time.sleep(0.005)

        thread = threading.Thread(target=count)
        thread.start()
        before, start = counts[0], time.time()
        stackmesh.mesh(testdata("femur.nii.gz"))
        took = time.time() - start
        counted = counts[0] - before
        stop.set()
        thread.join()
        self.assertGreater(counted, 10 * took, f"{counted} in {took:.1f} s")

    def test_any_number_of_threads_gives_the_same(self):
        self.assertTrue(same(stackmesh.mesh(ball(), threads=1), stackmesh.mesh(ball(), threads=3)))


class Ended(FolderTest):
    def ends(self, stage, wait, with_worker):
        """Starts a long run, sends Ctrl-C in that stage (and while TetGen works); how long it took to end, in s."""
        env = dict(os.environ, PYTHONPATH=os.pathsep.join(sys.path))
        process = subprocess.Popen([sys.executable, "-c", LONG, stage, self.path("out.vtu")], stdout=subprocess.PIPE, text=True, env=env, cwd=self.folder)
        try:
            self.assertEqual(process.stdout.readline().strip(), "now")
            time.sleep(wait)
            busy = workers_of(process.pid)
            while with_worker and not busy and process.poll() is None:
                time.sleep(0.01)
                busy = workers_of(process.pid)
            sent = time.time()
            process.send_signal(signal.SIGINT)
            rest = process.stdout.read().split()
            process.wait(60)
        finally:
            process.kill()
        rest = [w for w in rest if w != "now"]
        self.assertEqual(rest[0], "interrupted", rest)
        self.assertEqual(rest[2], "end")
        self.assertEqual(os.listdir(self.folder), [])
        time.sleep(0.1)
        self.assertEqual(workers_of(process.pid), [])
        for pid in busy:
            self.assertFalse(os.path.exists(f"/proc/{pid}"), "the worker outlived the run")
        return float(rest[1]) - sent, busy

    def test_by_ctrl_c_in_any_stage(self):
        for stage, wait, with_worker in (("contours", 0.1, False), ("stitch", 0.2, False), ("enhance", 0.5, False), ("volume", 0, True)):
            with self.subTest(stage):
                took, busy = self.ends(stage, wait, with_worker)
                print(f"Ctrl-C in {stage}: {took:.2f} s, workers then: {len(busy)}", file=sys.stderr)
                self.assertEqual(with_worker, len(busy) > 0)
                self.assertLess(took, 2.0)  # half a second on a machine that does nothing else

    def test_while_calculix_solves(self):
        """fem(accuracy=...): the solver and its folder go, too."""
        import shutil
        import tempfile

        if shutil.which("ccx") is None:
            self.skipTest("NOT TESTED: needs calculix-ccx")
        code = """
import sys
import stackmesh
try:
    stackmesh.fem(sys.argv[1] + "/femur.nii.gz", output="out.inp", materials=sys.argv[1] + "/femur_law.json", names=sys.argv[1] + "/femur_names.ctbl", edge_length=5, caps="flat", accuracy="1%")
except KeyboardInterrupt:
    print("interrupted", flush=True)
"""
        before = set(os.listdir(tempfile.gettempdir()))

        def solvers(pid):
            with open(f"/proc/{pid}/task/{pid}/children") as f:
                children = f.read().split()
            threads = [c for t in os.listdir(f"/proc/{pid}/task") for c in open(f"/proc/{pid}/task/{t}/children").read().split()]
            return [c for c in set(children + threads) if open(f"/proc/{c}/comm").read().startswith("ccx")]

        env = dict(os.environ, PYTHONPATH=os.pathsep.join(sys.path))
        process = subprocess.Popen([sys.executable, "-W", "ignore", "-c", code, testdata("")[:-1]], stdout=subprocess.PIPE, text=True, env=env, cwd=self.folder)
        try:
            running = []
            while not running and process.poll() is None:
                time.sleep(0.02)
                try:
                    running = solvers(process.pid)
                except OSError:
                    continue  # a thread or child that has ended meanwhile
            self.assertTrue(running, "the solver was never seen")
            sent = time.time()
            process.send_signal(signal.SIGINT)
            self.assertEqual(process.stdout.read().strip(), "interrupted")
            self.assertLess(time.time() - sent, 2.0)
            process.wait(60)
        finally:
            process.kill()
        self.assertFalse(any(os.path.exists(f"/proc/{c}") for c in running))
        self.assertEqual(os.listdir(self.folder), [])
        self.assertEqual([n for n in set(os.listdir(tempfile.gettempdir())) - before if n.startswith("stackmesh_ccx")], [])

    def test_by_a_callback_that_raises(self):
        class Stop(Exception):
            pass

        def told(stage, done):
            if stage == "stitch":
                raise Stop(stage)

        with self.assertRaises(Stop):
            stackmesh.mesh(testdata("heart4.nii.gz"), progress=told, output=self.path("o.vtu"))
        self.assertEqual(os.listdir(self.folder), [])
        self.assertEqual(workers_of(os.getpid()), [])
        self.assertGreater(len(stackmesh.mesh(ball()).tets), 0)


class Told(FolderTest):
    def test_progress_names_the_stages_in_order(self):
        told = []
        stackmesh.mesh(testdata("femur.nii.gz"), progress=lambda stage, done: told.append((stage, done, threading.get_ident())))
        stages = list(dict.fromkeys(stage for stage, _, _ in told))
        self.assertEqual([s for s in stages if s in ("contours", "stitch", "enhance", "volume")], ["contours", "stitch", "enhance", "volume"])
        self.assertTrue(all(0 <= done <= 1 and who == threading.get_ident() for _, done, who in told))

    def test_progress_true_is_a_bar_or_lines(self):
        import contextlib
        import io
        import types

        said = io.StringIO()
        with unittest.mock.patch.dict(sys.modules, {"tqdm": None, "tqdm.auto": None}), contextlib.redirect_stderr(said):
            stackmesh.mesh(ball(), progress=True)
        self.assertIn("stackmesh: stitch\n", said.getvalue())
        bars = []

        class Bar:
            def __init__(self, **options):
                self.shown, self.closed, self.total = [], False, options["total"]
                bars.append(self)

            def set_description(self, text):
                self.text = text

            def refresh(self):
                self.shown.append((self.text, self.n))

            def close(self):
                self.closed = True

        auto = types.ModuleType("tqdm.auto")
        auto.tqdm = Bar
        with unittest.mock.patch.dict(sys.modules, {"tqdm": types.ModuleType("tqdm"), "tqdm.auto": auto}):
            stackmesh.mesh(ball(), progress=True)
            with self.assertRaises(stackmesh.Error):
                stackmesh.mesh(ball(), spacing=1, caps="pointed", progress=True)
        self.assertTrue(all(bar.closed for bar in bars))
        self.assertIn(("volume", 100), bars[0].shown)

    def test_errors_carry_kind_place_and_mend(self):
        for call, kind, where in (
            (lambda: stackmesh.mesh("no/such/file.nii.gz"), "input", "no/such/file.nii.gz"),
            (lambda: stackmesh.mesh(ball(), label=9), "input", "9"),
            (lambda: stackmesh.mesh(ball(), interpolate="many"), "usage", "--interpolate"),
            (lambda: stackmesh.mesh(ball(), gradation=0.5), "usage", "gradation"),
            (lambda: stackmesh.mesh(ball(), output="no/such/folder/a.vtu"), "output", "no/such/folder"),
            (lambda: stackmesh.surface(ball()).save(self.path("a.vtu")), "usage", "a.vtu"),
            (lambda: stackmesh.mesh(ball()).save(self.path("a.txt")), "usage", "a.txt"),
            (lambda: stackmesh.mesh(ball(), spacing=1).save("no/such/folder/a.vtu"), "output", "no/such/folder"),
            (lambda: stackmesh.fem(stackmesh.surface(ball()), output=self.path("a.inp")), "usage", "mesh"),
        ):
            with self.assertRaises(stackmesh.Error) as raised:
                call()
            e = raised.exception
            self.assertEqual(e.kind, kind, str(e))
            self.assertIn(where, str(e))
            self.assertTrue(e.mend, str(e))
            self.assertIn(e.problem, str(e))
        self.assertEqual(os.listdir(self.folder), [])

    def test_a_mistyped_keyword_is_told(self):
        with self.assertRaisesRegex(TypeError, "did you mean edge_length"):
            stackmesh.mesh(ball(), edgelength=2)
        with self.assertRaisesRegex(TypeError, "True or False"):
            stackmesh.mesh(ball(), merge="yes")
        with self.assertRaises(TypeError):
            stackmesh.mesh(ball(), smooth=True)

    def test_a_worker_that_is_missing_is_told(self):
        code = "import numpy as np, stackmesh\ntry:\n stackmesh.mesh(np.ones((6, 6, 6), bool))\nexcept stackmesh.Error as e:\n print(e.kind)\n"
        env = dict(os.environ, PYTHONPATH=os.pathsep.join(sys.path), STACKMESH_WORKER="/no/such/worker")
        done = subprocess.run([sys.executable, "-c", code], env=env, stdout=subprocess.PIPE, text=True)
        self.assertIn(done.stdout.strip(), ("no_result", "internal"))


if __name__ == "__main__":
    unittest.main()
