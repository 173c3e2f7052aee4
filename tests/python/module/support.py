"""What the tests of the Python module share."""

import os
import subprocess
import tempfile
import unittest
import warnings

import numpy as np

SOURCE = os.path.abspath(os.path.join(os.path.dirname(__file__), "..", "..", ".."))
TESTDATA = os.path.join(SOURCE, "testdata")
PROGRAM = os.environ.get("STACKMESH_PROGRAM", os.path.join(SOURCE, "build", "stackmesh"))
warnings.simplefilter("ignore")


def testdata(name):
    return os.path.join(TESTDATA, name)


def command_line(*arguments):
    """Runs the program, which must end with 0."""
    done = subprocess.run([PROGRAM, *arguments, "--quiet"], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    if done.returncode != 0:
        raise AssertionError(f"{arguments} ended with {done.returncode}: {done.stderr}")


def read_bytes(path):
    with open(path, "rb") as f:
        return f.read()


def ball(n=16, dtype=np.int32):
    """A ball of label 2 in one of label 5, without any symmetry of the grid."""
    i, j, k = np.ogrid[:n, : n + 1, : n + 2]
    inner = (i - 7.2) ** 2 + (j - 7.9) ** 2 + (k - 8.1) ** 2 < 3.1**2
    outer = (i - 7.4) ** 2 + (j - 8.2) ** 2 + 0.8 * (k - 8.4) ** 2 < 6.1**2
    return np.where(inner, 2, np.where(outer, 5, 0)).astype(dtype)


def arrays_of(mesh):
    return [np.array(a) for a in (mesh.points, mesh.tets, mesh.tet_labels, mesh.triangles, mesh.triangle_labels)]


def same(a, b):
    return all(x.dtype == y.dtype and x.shape == y.shape and x.tobytes() == y.tobytes() for x, y in zip(arrays_of(a), arrays_of(b)))


class FolderTest(unittest.TestCase):
    """A test with a folder of its own."""

    def setUp(self):
        self._folder = tempfile.TemporaryDirectory()
        self.addCleanup(self._folder.cleanup)
        self.folder = self._folder.name

    def path(self, name):
        return os.path.join(self.folder, name)
