"""Runs every line of Python of docs/python.md, in order, as one script in a folder of its own."""

import io
import os
import re
import shutil
import subprocess
import unittest
from contextlib import redirect_stdout

from support import SOURCE, FolderTest, read_bytes


class Page(FolderTest):
    def test_every_line_runs(self):
        try:
            import meshio  # noqa: F401
            import vtkmodules  # noqa: F401
        except ImportError:
            self.skipTest("NOT TESTED: needs python3-meshio and python3-vtk9")
        with open(os.path.join(SOURCE, "docs", "python.md"), encoding="utf-8") as f:
            text = f.read()
        blocks = [(m.start(), m.group(1)) for m in re.finditer(r"^```python\n(.*?)^```", text, re.S | re.M)]
        self.assertGreater(len(blocks), 10)
        self.assertEqual(text.count("```python"), len(blocks))
        os.symlink(os.path.join(SOURCE, "testdata"), self.path("testdata"))
        names, before, printed = {}, os.getcwd(), io.StringIO()
        os.chdir(self.folder)
        try:
            with redirect_stdout(printed):
                for at, block in blocks:
                    line = text.count("\n", 0, at) + 1
                    exec(compile("\n" * line + block, "docs/python.md", "exec"), names)
        finally:
            os.chdir(before)
        for part in ("stackmesh.Mesh", "7 core", "pass", "cortical_cap_low"):
            self.assertIn(part, printed.getvalue())
        for name in ("pipe.vtu", "pipe_1.stl", "pipe_7.stl", "pipe.xdmf", "femur.png", "femur.inp"):
            self.assertGreater(os.path.getsize(self.path(name)), 500, name)
        self.assertEqual(read_bytes(self.path("femur.png"))[:4], b"\x89PNG")
        if shutil.which("ccx") is None:
            self.skipTest("NOT TESTED: the deck was not solved, calculix-ccx is missing")
        done = subprocess.run(["ccx", "-i", "femur"], cwd=self.folder, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        self.assertIn("Job finished", done.stdout)


if __name__ == "__main__":
    unittest.main()
