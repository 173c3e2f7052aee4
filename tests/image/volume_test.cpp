// Volume files written by hand: where their voxels lie in the world, and every way in which they can be bad.
#include <cmath>
#include <limits>

#include "image_files.h"

using namespace image_files;
using stackmesh::LabelVolume;
using stackmesh::read_label_volume;
using stackmesh::Vec3;

namespace {

class VolumeFile : public ImageTest {};

void expect_point(Vec3 p, double x, double y, double z, double tolerance = 1e-6) {
  EXPECT_NEAR(p.x, x, tolerance);
  EXPECT_NEAR(p.y, y, tolerance);
  EXPECT_NEAR(p.z, z, tolerance);
}
void expect_orthonormal(const LabelVolume& v) {
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) EXPECT_NEAR(dot(v.axes[i], v.axes[j]), i == j ? 1 : 0, 1e-14);
}
void expect_twelve(const LabelVolume& v) {
  ASSERT_EQ(v.voxels.size(), 12u);
  ASSERT_EQ(v.labels.size(), 5u);
  EXPECT_EQ(v.labels[0].number, 0);
  for (std::size_t i = 0; i < 12; ++i) EXPECT_EQ(v.labels[v.voxels[i]].number, twelve[i]);
  for (std::size_t i = 1; i < v.labels.size(); ++i) EXPECT_LT(v.labels[i - 1].number, v.labels[i].number);
}

TEST_F(VolumeFile, NiftiRasBecomesLps) {
  Nifti n;
  n.pixdim = {1, 2, 3, 4};
  n.srow = {2, 0, 0, 10, 0, 3, 0, 20, 0, 0, 4, 30};
  const LabelVolume v = read_label_volume(write("a.nii", n.header() + pack<std::uint8_t>(twelve)));
  expect_twelve(v);
  EXPECT_EQ(v.kind, "nifti");
  EXPECT_TRUE(v.anatomical);
  EXPECT_TRUE(v.warnings.empty());
  EXPECT_EQ(v.size, (std::array<int, 3>{3, 2, 2}));
  // RAS (10 + 2 i, 20 + 3 j, 30 + 4 k)
  expect_point(v.world(0, 0, 0), -10, -20, 30);
  expect_point(v.world(2, 1, 1), -14, -23, 34);
  EXPECT_EQ(number(v, 1, 1, 1), 9);
}

TEST_F(VolumeFile, NiftiQuaternionAndGzipAndBigEndianAreRead) {
  Nifti n;
  n.big_endian = true;
  n.datatype = 512;
  n.bits = 16;
  n.sform = 0;
  n.qform = 1;
  n.pixdim = {-1, 2, 3, 4};  // qfac -1: the third axis is mirrored
  const float s = std::sin(15 * M_PI / 180);
  n.quatern = {0, 0, s, 5, 6, 7};  // 30 degrees about z
  const LabelVolume v = read_label_volume(write("q.nii.gz", gzip(n.header() + pack<std::uint16_t>(twelve, true))));
  expect_twelve(v);
  expect_orthonormal(v);
  const double c = std::cos(M_PI / 6), t = std::sin(M_PI / 6);
  expect_point(v.world(0, 0, 0), -5, -6, 7, 1e-5);
  expect_point(v.world(1, 0, 0), -5 - 2 * c, -6 - 2 * t, 7, 1e-5);
  expect_point(v.world(0, 1, 0), -5 + 3 * t, -6 - 3 * c, 7, 1e-5);
  expect_point(v.world(0, 0, 1), -5, -6, 3, 1e-5);
  EXPECT_LT(dot(cross(v.axes[0], v.axes[1]), v.axes[2]), 0) << "the grid is left-handed";
}

TEST_F(VolumeFile, ObliqueLeftHandedSformKeepsItsPositions) {
  Nifti n;
  n.pixdim = {1, 2, 3, 4};
  const float c = std::cos(0.35f), s = std::sin(0.35f);
  n.srow = {-2 * c, -3 * s, 0, 5, -2 * s, 3 * c, 0, 6, 0, 0, 4, 7};
  const LabelVolume v = read_label_volume(write("o.nii", n.header() + pack<std::uint8_t>(twelve)));
  expect_orthonormal(v);
  expect_point(v.world(2, 1, 1), -(-4.0 * c - 3.0 * s + 5), -(-4.0 * s + 3.0 * c + 6), 11, 1e-5);
  EXPECT_LT(dot(cross(v.axes[0], v.axes[1]), v.axes[2]), 0);
}

TEST_F(VolumeFile, NiftiUnitsScaleSpacingAndOrigin) {
  Nifti n;
  n.units = 3;  // micrometre
  n.pixdim = {1, 500, 500, 1000};
  n.srow = {500, 0, 0, 2000, 0, 500, 0, 0, 0, 0, 1000, -3000};
  const LabelVolume v = read_label_volume(write("u.nii", n.header() + pack<std::uint8_t>(twelve)));
  EXPECT_NEAR(v.spacing_mm[2], 1, 1e-6);
  expect_point(v.world(1, 0, 0), -2.5, 0, -3);
  EXPECT_TRUE(v.warnings.empty());
}

TEST_F(VolumeFile, NiftiThatContradictsItselfWarns) {
  Nifti n;
  n.qform = 1;
  n.sform = 2;
  n.srow[3] = 40;
  const LabelVolume v = read_label_volume(write("two.nii", n.header() + pack<std::uint8_t>(twelve)));
  expect_point(v.origin_mm, 0, 0, 0);
  EXPECT_TRUE(has_warning(v.warnings, "40 mm apart"));
  n = {};
  n.sform = 0;
  EXPECT_TRUE(has_warning(read_label_volume(write("none.nii", n.header() + pack<std::uint8_t>(twelve))).warnings,
                          "no orientation"));
}

TEST_F(VolumeFile, NiftiIsNotMixedUpWithItsSibling) {
  std::vector<int> other(12, 7);
  write("x.nii", Nifti().header() + pack<std::uint8_t>(other));
  expect_twelve(read_label_volume(write("x.nii.gz", gzip(Nifti().header() + pack<std::uint8_t>(twelve)))));
  EXPECT_EQ(number(read_label_volume(at("x.nii")), 0, 0, 0), 7);
}

TEST_F(VolumeFile, EveryIntegerAndFloatTypeGivesTheSameLabels) {
  const struct {
    const char* type;
    Bytes data;
  } kinds[] = {{"uint8", pack<std::uint8_t>(twelve)},   {"int8", pack<std::int8_t>(twelve)},
               {"uint16", pack<std::uint16_t>(twelve)}, {"int16", pack<std::int16_t>(twelve)},
               {"uint32", pack<std::uint32_t>(twelve)}, {"int32", pack<std::int32_t>(twelve)},
               {"uint64", pack<std::uint64_t>(twelve)}, {"int64", pack<std::int64_t>(twelve)},
               {"float", pack<float>(twelve)},          {"double", pack<double>(twelve)}};
  for (const auto& k : kinds) {
    SCOPED_TRACE(k.type);
    expect_twelve(read_label_volume(write("t.nrrd", nrrd(k.type, lps_grid, k.data))));
  }
  Nifti n;
  n.datatype = 16;
  n.bits = 32;
  expect_twelve(read_label_volume(write("f.nii", n.header() + pack<float>(twelve))));
}

TEST_F(VolumeFile, EightBitConversionInPlaceKeepsEveryVoxel) {
  std::vector<int> values(30 * 20 * 10);
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = static_cast<int>((i * 2654435761u >> 7) % 256);
  const LabelVolume v =
      read_label_volume(write("e.nrrd", nrrd("uint8", lps_grid, pack<std::uint8_t>(values), "30 20 10")));
  ASSERT_EQ(v.voxels.size(), values.size());
  for (std::size_t i = 0; i < values.size(); ++i) ASSERT_EQ(v.labels[v.voxels[i]].number, values[i]);
  EXPECT_EQ(v.labels.size(), 256u);
}

TEST_F(VolumeFile, LargeLabelNumbersSurvive) {
  std::vector<double> values(12, 0);
  values[3] = 2147483647;
  values[4] = 70000;
  const LabelVolume v = read_label_volume(write("l.nrrd", nrrd("int64", lps_grid, pack<std::int64_t>(values))));
  ASSERT_EQ(v.labels.size(), 3u);
  EXPECT_EQ(v.labels[1].number, 70000);
  EXPECT_EQ(number(v, 0, 1, 0), 2147483647);
  values[3] = 2147483648.0;
  expect_unreadable(write("m.nrrd", nrrd("int64", lps_grid, pack<std::int64_t>(values))), {"2147483648", "too large"});
}

TEST_F(VolumeFile, NrrdBigEndianGzipDetachedAndRas) {
  expect_twelve(read_label_volume(
      write("b.nrrd", nrrd("unsigned short", lps_grid, pack<std::uint16_t>(twelve, true), "3 2 2", "raw", "big"))));
  expect_twelve(
      read_label_volume(write("g.nrrd", nrrd("short", lps_grid, gzip(pack<std::int16_t>(twelve)), "3 2 2", "gzip"))));
  write("d.raw", pack<std::uint8_t>(twelve));
  expect_twelve(read_label_volume(write("d.nhdr", nrrd("uchar", lps_grid + "data file: d.raw\n", ""))));
  const std::string ras =
      "space: right-anterior-superior\nspace directions: (0,2,0) (3,0,0) (0,0,4)\nspace origin: (10,20,30)\n";
  const LabelVolume v = read_label_volume(write("r.nrrd", nrrd("uchar", ras, pack<std::uint8_t>(twelve))));
  expect_twelve(v);
  EXPECT_EQ(v.kind, "nrrd");
  expect_point(v.world(0, 0, 0), -10, -20, 30);
  expect_point(v.world(2, 1, 1), -13, -24, 34);
  EXPECT_LT(dot(cross(v.axes[0], v.axes[1]), v.axes[2]), 0);
}

TEST_F(VolumeFile, SegmentNamesOfSlicerAreTaken) {
  const std::string segments =
      "Segment0_LabelValue:=9\nSegment0_Name:=left lung\nSegment1_LabelValue:=2\nSegment1_Name:=heart\n";
  const LabelVolume v =
      read_label_volume(write("s.seg.nrrd", nrrd("uchar", lps_grid + segments, pack<std::uint8_t>(twelve))));
  EXPECT_EQ(v.labels[4].name, "left lung");
  EXPECT_EQ(v.labels[2].name, "heart");
  EXPECT_EQ(v.labels[1].name, "");
}

TEST_F(VolumeFile, MetaImageIsRead) {
  const std::string grid = "TransformMatrix = 0 1 0 1 0 0 0 0 1\nOffset = 4 5 6\nElementSpacing = 2 3 4\n";
  const LabelVolume v = read_label_volume(write(
      "a.mha", metaimage("MET_SHORT", "BinaryDataByteOrderMSB = True\n" + grid, pack<std::int16_t>(twelve, true))));
  expect_twelve(v);
  EXPECT_EQ(v.kind, "metaimage");
  expect_point(v.world(1, 0, 0), 4, 7, 6);
  expect_point(v.world(0, 1, 1), 7, 5, 10);
  const Bytes packed = zlib(pack<std::uint8_t>(twelve));
  expect_twelve(read_label_volume(
      write("z.mha",
            metaimage("MET_UCHAR",
                      "CompressedData = True\nCompressedDataSize = " + std::to_string(packed.size()) + "\n", packed))));
  write("h.raw", pack<float>(twelve));
  Bytes h = metaimage("MET_FLOAT", "ElementSpacing = 1 1 2\n", "");
  h.replace(h.find("LOCAL"), 5, "h.raw");
  expect_twelve(read_label_volume(write("h.mhd", h)));
}

TEST_F(VolumeFile, GiplIsRead) {
  for (const std::string& file : {write("a.gipl", gipl(2, 3, 4)), write("a.gipl.gz", gzip(gipl(2, 3, 4)))}) {
    const LabelVolume v = read_label_volume(file);
    expect_twelve(v);
    EXPECT_EQ(v.kind, "gipl");
    EXPECT_EQ(v.spacing_mm, (std::array<double, 3>{2, 3, 4}));
  }
}

TEST_F(VolumeFile, FourthDimensionOfOneIsFineMoreIsNot) {
  Nifti n;
  n.dim[0] = 4;
  expect_twelve(read_label_volume(write("one.nii", n.header() + pack<std::uint8_t>(twelve))));
  n.dim[4] = 2;
  expect_unreadable(write("two.nii", n.header() + pack<std::uint8_t>(twelve) + pack<std::uint8_t>(twelve)),
                    {"three dimensions"});
}

TEST_F(VolumeFile, VectorAndColourImagesAreRefused) {
  Nifti n;
  n.datatype = 128;
  n.bits = 24;
  expect_unreadable(write("rgb.nii", n.header() + Bytes(36, 'a')), {"NIfTI type 128"});
  expect_unreadable(write("v.mha", metaimage("MET_UCHAR", "ElementNumberOfChannels = 3\n", Bytes(36, 'a'))),
                    {"several values"});
  const Bytes list =
      "NRRD0004\ntype: uchar\ndimension: 4\nsizes: 2 3 2 2\nkinds: list domain domain domain\nencoding: "
      "raw\n\n" +
      Bytes(24, '\1');
  expect_unreadable(write("l.nrrd", list), {"three dimensions"});
  const Bytes vector =
      "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 3 2 2\nkinds: vector domain domain\nencoding: raw\n\n" +
      Bytes(12, '\1');
  expect_unreadable(write("v.nrrd", vector), {"several values"});
}

TEST_F(VolumeFile, MissingUnknownAndEmptyFilesAreRefused) {
  expect_unreadable(at("no.nii.gz"), {"does not exist"});
  expect_unreadable(at("*.png"), {"no file matches"});
  expect_unreadable(write("a.dcm", "x"), {"ending", ".nii.gz"});
  for (const char* name : {"e.nii", "e.nii.gz", "e.nrrd", "e.mha", "e.gipl", "e.png", "e.tif"})
    expect_unreadable(write(name, ""), {});
  for (const char* name : {"g.nii", "g.nii.gz", "g.nrrd", "g.nhdr", "g.mha", "g.mhd", "g.gipl", "g.gipl.gz"})
    expect_unreadable(write(name, Bytes(2000, 'k')), {});
}

TEST_F(VolumeFile, EveryTruncationIsAnError) {
  const Bytes packed = zlib(pack<std::uint16_t>(twelve));
  const struct {
    const char* name;
    Bytes bytes;
  } files[] = {
      {"t.nii", Nifti().header() + pack<std::uint8_t>(twelve)},
      {"t.nii.gz", gzip(Nifti().header() + pack<std::uint8_t>(twelve))},
      {"t.nrrd", nrrd("uchar", lps_grid, pack<std::uint8_t>(twelve))},
      {"z.nrrd", nrrd("uchar", lps_grid, gzip(pack<std::uint8_t>(twelve)), "3 2 2", "gzip")},
      {"t.mha", metaimage("MET_UCHAR", "", pack<std::uint8_t>(twelve))},
      {"z.mha",
       metaimage("MET_USHORT", "CompressedData = True\nCompressedDataSize = " + std::to_string(packed.size()) + "\n",
                 packed)},
      {"t.gipl", gipl()},
      {"t.gipl.gz", gzip(gipl())},
      {"t.png", grey_png(4, 3, twelve)},
  };
  for (const auto& f : files) {
    ASSERT_NO_THROW(read_label_volume(write(f.name, f.bytes))) << f.name;
    for (std::size_t length = 0; length < f.bytes.size(); ++length) {
      SCOPED_TRACE(std::string(f.name) + " cut to " + std::to_string(length) + " of " + std::to_string(f.bytes.size()));
      expect_unreadable(write(f.name, f.bytes.substr(0, length)), {});
      if (HasFailure()) return;
    }
  }
}

TEST_F(VolumeFile, FlippedBitsInCompressedVoxelsAreFound) {
  const Bytes header = nrrd("uchar", lps_grid, "", "3 2 2", "gzip"), data = gzip(pack<std::uint8_t>(twelve));
  for (std::size_t i = 10; i < data.size(); ++i) {
    SCOPED_TRACE(i);
    Bytes bad = data;
    bad[i] ^= 4;
    expect_unreadable(write("f.nrrd", header + bad), {});
  }
  Bytes nii = gzip(Nifti().header() + pack<std::uint8_t>(twelve));
  nii[nii.size() - 12] ^= 1;  // a voxel
  expect_unreadable(write("f.nii.gz", nii), {"damaged"});
}

TEST_F(VolumeFile, BadSpacingIsAnErrorInEveryFormat) {
  const float inf = std::numeric_limits<float>::infinity(), nan = std::numeric_limits<float>::quiet_NaN();
  for (float s : {0.f, -2.f, inf, nan}) {
    SCOPED_TRACE(s);
    Nifti n;
    n.pixdim[2] = s;
    expect_unreadable(write("s.nii", n.header() + pack<std::uint8_t>(twelve)), {"voxel size", "axis 2"});
    expect_unreadable(write("s.gipl", gipl(1, s, 1)), {"voxel size", "axis 2"});
    const std::string text = std::isnan(s) ? "nan" : std::isinf(s) ? "inf" : s == 0 ? "0" : "-2";
    expect_unreadable(
        write("s.mha", metaimage("MET_UCHAR", "ElementSpacing = 1 " + text + " 1\n", pack<std::uint8_t>(twelve))),
        {"voxel size", "axis 2"});
    expect_unreadable(write("s.nrrd", nrrd("uchar", "spacings: 1 " + text + " 1\n", pack<std::uint8_t>(twelve))),
                      {"voxel size", "axis 2"});
  }
  expect_unreadable(write("z.nrrd", nrrd("uchar", "space: LPS\nspace directions: (1,0,0) (0,0,0) (0,0,1)\n",
                                         pack<std::uint8_t>(twelve))),
                    {"voxel size"});
}

TEST_F(VolumeFile, GridsThatDoublePrecisionCannotHoldAreRefused) {
  const Bytes voxels = pack<std::uint8_t>(twelve);
  for (const std::string size : {"1e200", "1e-200", "1.1e12", "0.9e-12"}) {
    expect_unreadable(write("s.nrrd", nrrd("uchar", "spacings: 1 " + size + " 1\n", voxels)),
                      {"voxel size", "axis 2", "between 1e-12 and 1e12"});
    expect_unreadable(write("s.mha", metaimage("MET_UCHAR", "ElementSpacing = 1 " + size + " 1\n", voxels)),
                      {"voxel size", "axis 2", "between 1e-12 and 1e12"});
  }
  for (const std::string size : {"1e12", "1e-12"}) {
    const auto v = stackmesh::read_label_volume(write("s.nrrd", nrrd("uchar", "spacings: 1 " + size + " 1\n", voxels)));
    EXPECT_EQ(v.spacing_mm[1], std::stod(size));
  }
  Nifti micron;  // 1e-11 of its unit is 1e-14 mm
  micron.pixdim = {1, 1, 1, 1e-11f};
  micron.units = 3;
  expect_unreadable(write("s.nii", micron.header() + voxels), {"voxel size", "axis 3"});

  const auto with_origin = [&](const std::string& x) {
    return nrrd("uchar", "space: LPS\nspace directions: (1,0,0) (0,2,0) (0,0,3)\nspace origin: (0," + x + ",0)\n",
                voxels);
  };
  expect_unreadable(write("o.nrrd", with_origin("-1e17")), {"1e+17 mm away", "voxels of 1 mm cannot be told apart"});
  EXPECT_EQ(stackmesh::read_label_volume(write("o.nrrd", with_origin("1e14"))).origin_mm.y, 1e14);

  stackmesh::ReadOptions options;
  options.spacing_mm = std::array<double, 3>{1, 1, 1e13};
  expect_error([&] { stackmesh::read_label_volume(at("none.png"), options); }, {"--spacing", "between 1e-12 and 1e12"},
               stackmesh::ErrorKind::usage);
}

TEST_F(VolumeFile, ShearBeyondToleranceIsAnError) {
  Nifti n;
  n.srow[1] = 3e-4f;
  expect_unreadable(write("s.nii", n.header() + pack<std::uint8_t>(twelve)), {"sheared"});
  n.srow[1] = 5e-5f;
  expect_orthonormal(read_label_volume(write("t.nii", n.header() + pack<std::uint8_t>(twelve))));
  const auto sheared = [&](const char* y) {
    return nrrd("uchar", std::string("space: LPS\nspace directions: (1,0,0) (") + y + ",1,0) (0,0,1)\n",
                pack<std::uint8_t>(twelve));
  };
  expect_unreadable(write("s.nrrd", sheared("0.0003")), {"sheared"});
  expect_orthonormal(read_label_volume(write("t.nrrd", sheared("0.00005"))));
  expect_unreadable(
      write("s.mha", metaimage("MET_UCHAR", "TransformMatrix = 1 0 0 0.1 1 0 0 0 1\n", pack<std::uint8_t>(twelve))),
      {"sheared"});
}

TEST_F(VolumeFile, WrongByteOrderInHeaderIsAnError) {
  Nifti n;
  Bytes h = n.header();
  n.big_endian = true;
  h.replace(40, 16, n.header().substr(40, 16));  // the dimensions only
  expect_unreadable(write("w.nii", h + pack<std::uint8_t>(twelve)), {"byte order"});
  expect_unreadable(write("w.gipl", gipl(1, 1, 1, 0xb88ae32au)), {"byte order"});
}

TEST_F(VolumeFile, AbsurdSizesAreRefusedWithoutTakingMemory) {
  Nifti n;
  n.dim = {3, 32767, 32767, 32767, 1, 1, 1, 1};
  expect_unreadable(write("h.nii", n.header() + pack<std::uint8_t>(twelve)), {"truncated"});
  expect_unreadable(write("h.nii.gz", gzip(n.header() + pack<std::uint8_t>(twelve))), {"truncated"});
  expect_unreadable(write("h.nrrd", nrrd("uchar", lps_grid, gzip("abc"), "99999 99999 9999", "gzip")), {"truncated"});
}

TEST_F(VolumeFile, IntensityImagesAreRefused) {
  std::vector<double> values(12, 1);
  values[7] = -1024;
  expect_unreadable(write("n.nrrd", nrrd("short", lps_grid, pack<std::int16_t>(values))),
                    {"intensity image", "-1024", "voxel (1, 0, 1)"});
  expect_unreadable(write("n.nrrd", nrrd("float", lps_grid, pack<float>(values))),
                    {"intensity image", "-1024", "voxel (1, 0, 1)"});
  values[7] = 0.5;
  expect_unreadable(write("f.nrrd", nrrd("double", lps_grid, pack<double>(values))),
                    {"not a whole number", "0.5", "voxel (1, 0, 1)"});
  values[7] = std::nan("");
  expect_unreadable(write("f.nrrd", nrrd("float", lps_grid, pack<float>(values))), {"not a whole number"});
}

TEST_F(VolumeFile, AThousandLabelsAreReadAndOneMoreIsAnIntensityImage) {
  std::vector<int> values(1001);
  for (int i = 0; i < 1001; ++i) values[i] = 1000 - i;  // 1000 ... 0
  for (bool wide : {false, true}) {
    const auto data = [&] { return wide ? pack<std::uint32_t>(values) : pack<std::uint16_t>(values); };
    const char* type = wide ? "uint32" : "uint16";
    values.back() = 0;
    const LabelVolume v = read_label_volume(write("k.nrrd", nrrd(type, lps_grid, data(), "1001 1 1")));
    EXPECT_EQ(v.labels.size(), 1001u);
    EXPECT_EQ(number(v, 0, 0, 0), 1000);
    EXPECT_EQ(number(v, 999, 0, 0), 1);
    values.back() = 1001;
    expect_unreadable(write("k.nrrd", nrrd(type, lps_grid, data(), "1001 1 1")), {"intensity image", "1000 distinct"});
  }
}

TEST_F(VolumeFile, WithoutAnyLabelIsAnError) {
  expect_unreadable(write("z.nrrd", nrrd("uchar", lps_grid, Bytes(12, '\0'))), {"no label"});
}

TEST_F(VolumeFile, SpacingOptionIsForSlicesOnly) {
  stackmesh::ReadOptions options;
  options.spacing_mm = std::array<double, 3>{1, 1, 1};
  const std::string file = write("a.gipl", gipl());
  expect_error([&] { read_label_volume(file, options); }, {"--spacing"}, stackmesh::ErrorKind::usage);
}

}  // namespace
