"""Arrays of every kind are meshed alike, or refused with one clear error."""

import unittest

import numpy as np
import stackmesh
from support import ball, same, testdata

LABELS = ball()


class Arrays(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.expected = stackmesh.mesh(LABELS, spacing=(1, 1, 1.5))

    def is_meshed_alike(self, labels):
        before = labels.copy()
        self.assertTrue(same(stackmesh.mesh(labels, spacing=(1, 1, 1.5)), self.expected))
        self.assertTrue((before == labels).all(), "the array was changed")

    def test_fortran_order(self):
        self.is_meshed_alike(np.asfortranarray(LABELS))

    def test_c_order(self):
        self.is_meshed_alike(np.ascontiguousarray(LABELS))

    def test_every_type_of_whole_numbers_and_floats(self):
        for dtype in ("i1", "i2", "i4", "i8", "u1", "u2", "u4", "u8", "f2", "f4", "f8", "longdouble"):
            with self.subTest(dtype):
                self.is_meshed_alike(LABELS.astype(dtype))

    def test_big_endian(self):
        for dtype in (">i2", ">i4", ">i8", ">u2", ">f4", ">f8"):
            with self.subTest(dtype):
                self.is_meshed_alike(LABELS.astype(dtype))

    def test_negative_strides(self):
        for axis in range(3):
            self.is_meshed_alike(np.flip(np.flip(LABELS, axis).copy(), axis))

    def test_steps_and_transposed_axes(self):
        wide = np.zeros([2 * n for n in LABELS.shape], np.int16)
        wide[::2, 1::2, ::2] = LABELS
        self.is_meshed_alike(wide[::2, 1::2, ::2])
        self.is_meshed_alike(LABELS.transpose(2, 0, 1).copy().transpose(1, 2, 0))

    def test_read_only(self):
        labels = LABELS.copy()
        labels.setflags(write=False)
        self.is_meshed_alike(labels)

    def test_nested_lists(self):
        self.assertTrue(same(stackmesh.mesh(LABELS.tolist(), spacing=(1, 1, 1.5)), self.expected))

    def test_bool_is_label_1(self):
        mask = LABELS > 0
        self.assertTrue(same(stackmesh.mesh(mask), stackmesh.mesh(mask.astype(np.uint8))))
        self.assertEqual(list(stackmesh.mesh(mask).names), [1])

    def test_large_label_numbers(self):
        labels = np.where(LABELS > 0, 2_000_000_000, 0).astype(np.int64)
        self.assertEqual(set(stackmesh.mesh(labels).tet_labels), {2_000_000_000})


class Refused(unittest.TestCase):
    def refuses(self, labels, *parts, kind="input", **options):
        with self.assertRaises(stackmesh.Error) as raised:
            stackmesh.mesh(labels, **options)
        e = raised.exception
        self.assertEqual(e.kind, kind)
        self.assertTrue(e.problem and e.mend, str(e))
        for part in parts:
            self.assertIn(part, str(e))

    def test_nan_names_the_voxel(self):
        for dtype in (np.float32, np.float64):
            labels = LABELS.astype(dtype)
            labels[3, 4, 5] = np.nan
            self.refuses(labels, "nan", "[3, 4, 5]")

    def test_infinity_fractions_and_negative_numbers(self):
        for value in (np.inf, 1.5, -1):
            labels = LABELS.astype(float)
            labels[1, 2, 3] = value
            self.refuses(labels, "[1, 2, 3]")
        labels = LABELS.astype(np.int8)
        labels[1, 2, 3] = -7
        self.refuses(labels, "-7", "[1, 2, 3]")

    def test_too_large_a_number(self):
        labels = LABELS.astype(np.uint64)
        labels[0, 0, 0] = 2**63
        self.refuses(labels, "[0, 0, 0]", "too large")

    def test_no_voxels(self):
        for shape in ((0, 4, 4), (4, 0, 4), (4, 4, 0), (0, 0, 0)):
            self.refuses(np.zeros(shape, np.uint8), "empty")

    def test_two_and_four_dimensions(self):
        self.refuses(LABELS[0], "2 dimensions")
        self.refuses(LABELS[None], "4 dimensions")
        self.refuses(np.int32(1), "0 dimensions")

    def test_no_label(self):
        self.refuses(np.zeros((4, 4, 4), np.uint8), "background")

    def test_one_slice(self):
        self.refuses(LABELS[:, :, 8:9], axis="z")

    def test_other_types(self):
        self.refuses(LABELS.astype(complex), "complex")
        self.refuses(LABELS.astype(object), "object")
        self.refuses(LABELS.astype(str))

    def test_an_intensity_image(self):
        self.refuses(np.random.default_rng(1).integers(0, 30000, (30, 30, 30)), "intensity")

    def test_spacing(self):
        for spacing in ((1, 1), (1, 0, 1), (1, 1, -2), (1, np.nan, 1)):
            self.refuses(LABELS, "spacing", spacing=spacing)
        self.refuses(LABELS, "affine", kind="usage", affine=np.eye(4), spacing=(1, 1, 1))

    def test_affine(self):
        sheared = np.eye(4)
        sheared[0, 1] = 0.3
        self.refuses(LABELS, "sheared", affine=sheared)
        self.refuses(LABELS, "column 2", affine=np.diag([1.0, 1, 0, 1]))
        self.refuses(LABELS, "shape", affine=np.eye(3))
        self.refuses(LABELS, "finite", affine=np.full((4, 4), np.nan))
        self.refuses(LABELS, "last row", affine=np.ones((4, 4)))
        self.refuses(testdata("femur.nii.gz"), "affine", kind="usage", affine=np.eye(4))

    def test_ras_without_anatomy(self):
        self.refuses(LABELS, "--space ras", kind="usage", space="ras")


class Places(unittest.TestCase):
    def test_affine_is_ras_and_points_are_lps(self):
        affine = np.diag([0.5, 0.75, 2, 1.0])
        affine[:3, 3] = [10, -20, 30]
        lps, ras = stackmesh.mesh(LABELS, affine), stackmesh.mesh(LABELS, affine, space="ras")
        plain = stackmesh.mesh(LABELS, spacing=(0.5, 0.75, 2))
        self.assertEqual((lps.space, ras.space, plain.space), ("lps", "ras", "none"))
        self.assertTrue((np.array(lps.points) * [-1, -1, 1] == ras.points).all())
        index = np.argwhere(LABELS > 0)
        low, high = index.min(axis=0), index.max(axis=0)
        to_mm = np.array([0.5, 0.75, 2])
        for points, origin in ((ras.points, affine[:3, 3]), (plain.points, np.zeros(3))):
            self.assertTrue(np.allclose(points.min(axis=0), origin + (low - 0.5) * to_mm, atol=1.1))
            self.assertTrue(np.allclose(points.max(axis=0), origin + (high + 0.5) * to_mm, atol=1.1))

    def test_an_affine_that_mirrors_leaves_tets_positive(self):
        for signs in ((1, 1, 1), (-1, 1, 1), (1, -1, -1)):
            m = stackmesh.mesh(LABELS, np.diag([*signs, 1.0]))
            a, b, c, d = (m.points[m.tets[:, n]] for n in range(4))
            self.assertGreater(np.einsum("nd,nd->n", np.cross(b - a, c - a), d - a).min(), 0)

    def test_names_of_a_dict(self):
        m = stackmesh.mesh(LABELS, names={2: "core", 5: "shell", 9: "absent"})
        self.assertEqual(m.names, {2: "core", 5: "shell"})
        self.assertEqual({r["name"] for r in m.report["labels"]}, {"core", "shell"})


if __name__ == "__main__":
    unittest.main()
