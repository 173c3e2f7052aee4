// Kinds of files whose numbers, places or order were once taken otherwise than they are stored.
#include <cmath>

#include "image_files.h"

using namespace image_files;
using stackmesh::LabelVolume;
using stackmesh::read_label_volume;
using stackmesh::ReadOptions;
using stackmesh::Vec3;

namespace {

class StoredNumbers : public ImageTest {};

std::vector<int> numbers_of(const LabelVolume& v) {
  std::vector<int> all;
  for (const std::uint16_t voxel : v.voxels) all.push_back(v.labels[voxel].number);
  return all;
}

TEST_F(StoredNumbers, EverySpaceOfNrrdIsTurnedByItsName) {
  const struct {
    const char* space;
    double x, y, z;
  } spaces[] = {{"left-posterior-superior", 1, 1, 1},   {"LPS", 1, 1, 1},
                {"right-anterior-superior", -1, -1, 1}, {"RAS", -1, -1, 1},
                {"left-anterior-superior", 1, -1, 1},   {"LAS", 1, -1, 1},
                {"Left-Anterior-Superior", 1, -1, 1},   {"scanner-xyz", 1, 1, 1}};
  for (const auto& s : spaces) {
    SCOPED_TRACE(s.space);
    const LabelVolume v = read_label_volume(
        write("s.nrrd", nrrd("uchar",
                             std::string("space: ") + s.space +
                                 "\nspace directions: (2,0,0) (0,3,0) (0,0,4)\nspace origin: (10,20,30)\n",
                             pack<std::uint8_t>(twelve))));
    const Vec3 p = v.world(2, 1, 1);
    EXPECT_NEAR(p.x, s.x * 14, 1e-12);
    EXPECT_NEAR(p.y, s.y * 23, 1e-12);
    EXPECT_NEAR(p.z, s.z * 34, 1e-12);
  }
  expect_unreadable(write("u.nrrd", nrrd("uchar", "space: upside-down\n", pack<std::uint8_t>(twelve))),
                    {"'upside-down'"});
}

TEST_F(StoredNumbers, AxesOfOneVoxelThatAreTooManyAreDropped) {
  const auto four = [](const std::string& sizes, const std::string& more) {
    return "NRRD0004\ntype: uchar\ndimension: 4\nsizes: " + sizes + "\nencoding: raw\n" + more + "\n" +
           pack<std::uint8_t>(twelve);
  };
  const struct {
    const char *sizes, *more;
  } files[] = {
      {"3 2 2 1", ""},
      {"1 3 2 2", ""},
      {"3 1 2 2", ""},
      {"3 2 2 1", "space: LPS\nspace directions: (1,0,0) (0,1,0) (0,0,1) none\n"},
      {"1 3 2 2", "space: LPS\nkinds: list domain domain domain\nspace directions: none (1,0,0) (0,1,0) (0,0,1)\n"},
      {"3 2 2 1", "kinds: domain domain domain time\n"},
      {"3 2 2 1", "space: left-posterior-superior-time\nspace directions: (1,0,0,0) (0,1,0,0) (0,0,1,0) (0,0,0,1)\n"}};
  for (const auto& f : files) {
    SCOPED_TRACE(std::string(f.sizes) + " " + f.more);
    const LabelVolume v = read_label_volume(write("f.nrrd", four(f.sizes, f.more)));
    EXPECT_EQ(v.size, (std::array<int, 3>{3, 2, 2}));
    EXPECT_EQ(numbers_of(v), twelve);
  }
  const Bytes segments = "Segment3_ID:=s\nSegment3_LabelValue:=9\nSegment3_Name:=spleen\n";
  const LabelVolume v = read_label_volume(write(
      "s.seg.nrrd",
      four("1 3 2 2", "space: LPS\nkinds: list domain domain domain\nspace directions: none (1,0,0) (0,1,0) (0,0,1)\n" +
                          segments)));
  EXPECT_EQ(v.labels.back().name, "spleen");
  Bytes m = metaimage("MET_UCHAR", "ElementSpacing = 1 1 1 1\n", pack<std::uint8_t>(twelve));
  m.replace(m.find("NDims = 3"), 9, "NDims = 4");
  m.replace(m.find("3 2 2"), 5, "3 2 2 1");
  EXPECT_EQ(numbers_of(read_label_volume(write("m.mha", m))), twelve);
}

TEST_F(StoredNumbers, TextHexSkipsAndListsOfNrrdAreRead) {
  Bytes text, hex;
  for (int v : twelve) {
    char two[8];
    std::snprintf(two, sizeof two, "%02X", v);
    text += std::to_string(v) + (text.size() % 3 ? " " : "\n");
    hex += two;
  }
  const auto reads = [&](const Bytes& file) {
    EXPECT_EQ(numbers_of(read_label_volume(write("a.nhdr", file))), twelve);
  };
  reads(nrrd("uchar", lps_grid, text, "3 2 2", "ascii"));
  reads(nrrd("double", lps_grid, text, "3 2 2", "text"));
  reads(nrrd("uchar", lps_grid, hex, "3 2 2", "hex"));
  reads(nrrd("uchar", lps_grid + "line skip: 2\nbyte skip: 3\n", "one\ntwo\nabc" + pack<std::uint8_t>(twelve)));
  reads(nrrd("uchar", lps_grid + "byte skip: -1\n", "whatever" + pack<std::uint8_t>(twelve)));
  reads(nrrd("uchar", lps_grid + "byte skip: 3\n", gzip("abc" + pack<std::uint8_t>(twelve)), "3 2 2", "gzip"));
  write("p1.raw", pack<std::uint8_t>(twelve).substr(0, 6));
  write("p2.raw", pack<std::uint8_t>(twelve).substr(6));
  reads(nrrd("uchar", lps_grid + "data file: LIST\np1.raw\np2.raw\n", ""));
  reads(nrrd("uchar", lps_grid + "data file: p%d.raw 1 2 1\n", ""));
  expect_unreadable(write("b.nhdr", nrrd("uchar", lps_grid + "data file: LIST\np1.raw\np3.raw\n", "")),
                    {"p3.raw", "missing"});
  write("p3.raw", "abc");
  expect_unreadable(write("b.nhdr", nrrd("uchar", lps_grid + "data file: LIST\np1.raw\np3.raw\n", "")),
                    {"p3.raw", "truncated"});
  expect_unreadable(write("c.nrrd", nrrd("uchar", lps_grid, "0 1 2 300 0 5 0 0 0 0 9 0", "3 2 2", "ascii")), {"'300'"});
  expect_unreadable(write("c.nrrd", nrrd("uchar", lps_grid, "0 1 2 x 0 5 0 0 0 0 9 0", "3 2 2", "ascii")), {"'x'"});
  for (const char* encoding : {"bzip2", "zrl"})
    expect_unreadable(write("d.nrrd", nrrd("uchar", lps_grid, "BZh9", "3 2 2", encoding)), {encoding, "not supported"});
}

TEST_F(StoredNumbers, SliceFilesOfMetaImageAreAllThereOrNamed) {
  Bytes header = metaimage("MET_UCHAR", "", "");
  const auto with = [&](const std::string& files) {
    Bytes h = header;
    return h.replace(h.find("LOCAL\n"), 6, files);
  };
  write("s1.raw", pack<std::uint8_t>(twelve).substr(0, 6));
  write("s2.raw", pack<std::uint8_t>(twelve).substr(6));
  for (const char* files : {"LIST\ns1.raw\ns2.raw\n", "LIST 2D\ns1.raw\ns2.raw\n", "s%d.raw 1 2 1\n", "s%d.raw\n",
                            "s%d.raw 1 2\n", "s%d.raw 1\n"}) {
    SCOPED_TRACE(files);
    EXPECT_EQ(numbers_of(read_label_volume(write("a.mhd", with(files)))), twelve);
  }
  expect_unreadable(write("a.mhd", with("LIST\ns1.raw\ns3.raw\n")), {"s3.raw", "missing"});
  expect_unreadable(write("a.mhd", with("s%d.raw 2 3 1\n")), {"s3.raw", "missing"});
  expect_unreadable(write("a.mhd", with("LIST\ns1.raw\n")), {"truncated", "s1.raw"});
  expect_unreadable(write("a.mhd", with("LIST\ns1.raw\ns2.raw\ns1.raw\n")), {"3 data files for 2 slices"});
  expect_unreadable(write("a.mhd", with("s%s%d.raw 1 2 1\n")), {"pattern"});
  for (const auto& [bytes, what] : {std::pair<const char*, const char*>{"12345", "truncated"},
                                    {"1234567", "7 bytes where its header needs 6"},
                                    {"", "empty"}}) {
    write("s2.raw", bytes);
    expect_unreadable(write("a.mhd", with("LIST\ns1.raw\ns2.raw\n")), {"s2.raw", what});
  }
}

TEST_F(StoredNumbers, ADetachedHeaderStaysInItsFolder) {
  write("data.raw", pack<std::uint8_t>(twelve));
  write("in/deeper/data.raw", pack<std::uint8_t>(twelve));
  const auto both = [&](const std::string& name) {
    Bytes m = metaimage("MET_UCHAR", "", "");
    return std::vector<std::string>{write("in/a.nhdr", nrrd("uchar", lps_grid + "data file: " + name + "\n", "")),
                                    write("in/a.mhd", m.replace(m.find("LOCAL"), 5, name))};
  };
  for (const std::string& file : both("deeper/data.raw")) EXPECT_EQ(numbers_of(read_label_volume(file)), twelve);
  for (const std::string& name : {std::string("../data.raw"), at("data.raw"), std::string("deeper/../../data.raw"),
                                  std::string("/etc/passwd"), std::string("/dev/zero")})
    for (const std::string& file : both(name))
      expect_unreadable(file, {"outside of the header's folder", "--allow-outside"});
  ReadOptions options;
  options.allow_outside = true;
  for (const std::string& file : both("../data.raw")) EXPECT_EQ(numbers_of(read_label_volume(file, options)), twelve);
  for (const std::string& file : both("/dev/zero"))
    expect_error([&] { read_label_volume(file, options); }, {"no regular file"});
}

TEST_F(StoredNumbers, SlopesAreRoundedWhereTheyGiveNearlyWholeNumbersOnly) {
  Nifti n;
  n.datatype = 4;
  n.bits = 16;
  n.slope = 9.0f / 65534;  // labels 0 to 9 over all 16 bits, as editors store them
  n.inter = 4.5f;
  std::vector<int> stored;
  for (int v : twelve) stored.push_back(static_cast<int>(std::lround((v - static_cast<double>(n.inter)) / n.slope)));
  const LabelVolume v = read_label_volume(write("a.nii", n.header() + pack<std::int16_t>(stored)));
  EXPECT_EQ(numbers_of(v), twelve);
  EXPECT_TRUE(has_warning(v.warnings, "rounded"));
  n.inter = 0;
  n.slope = 0.5f;
  expect_unreadable(
      write("b.nii", n.header() + pack<std::int16_t>(std::vector<int>{0, 2, 4, 1, 0, 0, 0, 0, 0, 0, 0, 0})),
      {"0.5", "not a whole number", "voxel (0, 1, 0)"});
  n.slope = 1.0f / 255;  // a probability map
  expect_unreadable(
      write("c.nii", n.header() + pack<std::int16_t>(std::vector<int>{0, 255, 128, 64, 0, 0, 0, 0, 0, 0, 0, 0})),
      {"not a whole number"});
  for (const float slope : {0.f, std::nanf("")}) {
    n.slope = slope;
    n.inter = 5;
    EXPECT_EQ(numbers_of(read_label_volume(write("d.nii", n.header() + pack<std::int16_t>(twelve)))), twelve);
  }
}

TEST_F(StoredNumbers, GreyPngOfFewBitsIsNotStretched) {
  // 4 x 1 pixels: 0 1 2 3 in two bits, 0 1 9 15 in four, 0 1 1 0 in one
  const struct {
    int bits;
    Bytes row;
    std::vector<int> labels;
  } files[] = {{1, Bytes("\x60", 1), {0, 1, 1, 0}},
               {2, Bytes("\x1b", 1), {0, 1, 2, 3}},
               {4, Bytes("\x01\x9f", 2), {0, 1, 9, 15}}};
  for (const auto& f : files) {
    SCOPED_TRACE(f.bits);
    EXPECT_EQ(numbers_of(read_label_volume(write("a.png", png(4, 1, f.bits, 0, f.row)))), f.labels);
  }
}

TEST_F(StoredNumbers, AJpegUnderTheNameOfAPngIsNamed) {
  expect_unreadable(write("a.png", Bytes("\xff\xd8\xff\xe0 and so on")), {"JPEG"});
}

TEST_F(StoredNumbers, ASmallStreamThatClaimsMuchTakesNoMemory) {
  Nifti n;
  n.dim = {3, 1000, 1000, 1000, 1, 1, 1, 1};
  Bytes noise(1100000, '\0');  // a megabyte that a gigabyte could be in, by its size
  std::uint32_t state = 1;
  for (char& c : noise) c = static_cast<char>((state = state * 1664525u + 1013904223u) >> 24);
  const std::string file = write("n.nii.gz", gzip(n.header() + noise));
  const auto peak_mb = [] {
    std::ifstream status("/proc/self/status");
    for (std::string line; std::getline(status, line);)
      if (line.compare(0, 6, "VmHWM:") == 0) return std::stol(line.substr(6)) / 1024;
    return 0L;
  };
  const long before = peak_mb();
  expect_unreadable(file, {"truncated", "1100352 bytes"});
  EXPECT_LT(peak_mb() - before, 200);
}

TEST_F(StoredNumbers, PngFiltersAreUndone) {
  // rows of 3 pixels by each of the five filters, decoded by hand
  const Bytes rows(
      "\0\1\2\3"
      "\1\1\1\1"
      "\2\1\1\1"
      "\3\1\1\1"
      "\4\1\1\1",
      20);
  const LabelVolume v = read_label_volume(write("a.png", png_of_stream(3, 5, 8, 0, zlib(rows))));
  EXPECT_EQ(numbers_of(v), (std::vector<int>{1, 2, 3, 1, 2, 3, 2, 3, 4, 2, 3, 4, 3, 4, 5}));
}

TEST_F(StoredNumbers, InterlacedPngIsPutTogether) {
  // The passes of 5 x 3 pixels, by the table of the PNG specification: each holds the pixels of its own columns and
  // rows, and every row of a pass begins with its filter.
  const int columns[7][2] = {{0, 8}, {4, 8}, {0, 4}, {2, 4}, {0, 2}, {1, 2}, {0, 1}},
            rows[7][2] = {{0, 8}, {0, 8}, {4, 8}, {0, 4}, {2, 4}, {0, 2}, {1, 2}};
  std::vector<int> labels;
  for (int i = 0; i < 15; ++i) labels.push_back(1 + 17 * i % 250);
  for (int bits : {8, 16}) {
    SCOPED_TRACE(bits);
    Bytes stream;
    for (int pass = 0; pass < 7; ++pass)
      for (int y = rows[pass][0]; y < 3 && columns[pass][0] < 5; y += rows[pass][1]) {
        stream += '\0';
        for (int x = columns[pass][0]; x < 5; x += columns[pass][1])
          stream += bits == 8 ? Bytes(1, static_cast<char>(labels[5 * y + x]))
                              : big<std::uint16_t>(static_cast<std::uint16_t>(labels[5 * y + x]));
      }
    EXPECT_EQ(numbers_of(read_label_volume(write("a.png", png_of_stream(5, 3, bits, 0, zlib(stream), true)))), labels);
    const Bytes shorter = stream.substr(0, stream.size() - 1);
    expect_unreadable(write("a.png", png_of_stream(5, 3, bits, 0, zlib(shorter), true)), {"too few pixels"});
  }
}

TEST_F(StoredNumbers, OpacityOfAPngDoesNotCount) {
  EXPECT_EQ(numbers_of(read_label_volume(write("a.png", png(2, 1, 8, 4, Bytes("\3\0\4\xff", 4))))),
            (std::vector<int>{3, 4}));
  EXPECT_EQ(numbers_of(read_label_volume(write("b.png", png(1, 1, 16, 6, Bytes("\1\2\1\2\1\2\0\0", 8))))),
            (std::vector<int>{258}));
}

TEST_F(StoredNumbers, DamageOfAPngIsToldApart) {
  const Bytes rows("\0\1\2\0\3\4", 6), stream = zlib(rows), whole = png_of_stream(2, 2, 8, 0, stream);
  EXPECT_EQ(numbers_of(read_label_volume(write("a.png", whole))), (std::vector<int>{1, 2, 3, 4}));
  for (std::size_t length : {std::size_t{9}, std::size_t{30}, whole.size() - 20, whole.size() - 1})
    expect_unreadable(write("a.png", whole.substr(0, length)), {"truncated"});
  for (std::size_t at : {std::size_t{20}, std::size_t{42}, whole.size() - 18}) {
    Bytes damaged = whole;
    damaged[at] ^= 1;
    expect_unreadable(write("a.png", damaged), {"damaged (check sum)"});
  }
  Bytes checked = stream;  // by its own check sum, in its last four bytes
  checked.back() ^= 1;
  for (std::size_t first : {std::size_t{3}, checked.size() - 4, checked.size()})
    expect_unreadable(write("a.png", png_of_stream(2, 2, 8, 0, checked, false, first)), {"damaged (pixels)"});
  expect_unreadable(write("a.png", png_of_stream(2, 2, 8, 0, zlib(Bytes("\0\1\2\5\3\4", 6)))), {"damaged (pixels)"});
  expect_unreadable(write("a.png", png_of_stream(2, 2, 8, 0, zlib(rows.substr(0, 5)))), {"too few pixels"});
  expect_unreadable(write("a.png", png_of_stream(999999, 999999, 8, 0, stream)), {"too few pixels"});
  expect_unreadable(write("a.png", png_of_stream(1000001, 2, 8, 0, stream)), {"size in its header"});
  expect_unreadable(write("a.png", png_of_stream(2, 2, 3, 0, stream)), {"damaged (header)"});
  // Neither chunks of any length nor what follows the pixels is damage.
  for (std::size_t first = 0; first < stream.size(); ++first)
    EXPECT_EQ(numbers_of(read_label_volume(write("a.png", png_of_stream(2, 2, 8, 0, stream, false, first)))),
              (std::vector<int>{1, 2, 3, 4}));
  for (const Bytes& more : {zlib(rows + Bytes(9, '\7')), stream + "more"})
    EXPECT_EQ(numbers_of(read_label_volume(write("a.png", png_of_stream(2, 2, 8, 0, more)))),
              (std::vector<int>{1, 2, 3, 4}));
}

/// A TIFF page whose tags 258 (bits), 262 (photometric), 339 (format) are as given; tag 320 (palette) where photometric
/// is 3.
Bytes tiff_page(int width, int height, int bits, int photometric, int format, const Bytes& data) {
  const bool palette = photometric == 3;
  const int entries = palette ? 11 : 10;
  const auto at = static_cast<std::uint32_t>(8 + 2 + 12 * entries + 4), colours = palette ? 3u << bits : 0;
  Bytes out = Bytes("II*\0", 4) + little<std::uint32_t>(8) + little<std::uint16_t>(entries);
  const auto entry = [&](int tag, int type, std::uint32_t count, std::uint32_t value) {
    out += little<std::uint16_t>(tag) + little<std::uint16_t>(type) + little(count) + little(value);
  };
  const std::uint32_t pixels = at + (palette ? 2 * colours : 0);
  entry(256, 4, 1, width), entry(257, 4, 1, height), entry(258, 3, 1, bits), entry(259, 3, 1, 1),
      entry(262, 3, 1, photometric), entry(273, 4, 1, pixels);
  entry(277, 3, 1, 1), entry(278, 4, 1, height), entry(279, 4, 1, static_cast<std::uint32_t>(data.size()));
  if (palette) entry(320, 3, colours, at);
  entry(339, 3, 1, format);
  out += little<std::uint32_t>(0);
  for (std::uint32_t c = 0; palette && c < colours; ++c) out += little<std::uint16_t>(257 * (c * 37 % 256));
  return out + data;
}

TEST_F(StoredNumbers, TiffPhotometricPaletteBitsAndFormats) {
  const std::vector<int> four = {0, 1, 2, 3};
  for (int photometric : {0, 1, 3}) {
    SCOPED_TRACE(photometric);
    EXPECT_EQ(
        numbers_of(read_label_volume(write("a.tif", tiff_page(2, 2, 8, photometric, 1, pack<std::uint8_t>(four))))),
        four);
    EXPECT_EQ(numbers_of(read_label_volume(write("a.tif", tiff_page(2, 2, 4, photometric, 1, Bytes("\x01\x23", 2))))),
              four);
    if (photometric == 3) continue;
    EXPECT_EQ(
        numbers_of(read_label_volume(write("a.tif", tiff_page(2, 2, 16, photometric, 1, pack<std::uint16_t>(four))))),
        four);
    EXPECT_EQ(numbers_of(read_label_volume(write("a.tif", tiff_page(4, 1, 1, photometric, 1, Bytes("\x60", 1))))),
              (std::vector<int>{0, 1, 1, 0}));
    EXPECT_EQ(numbers_of(read_label_volume(write("a.tif", tiff_page(4, 1, 2, photometric, 1, Bytes("\x1b", 1))))),
              four);
  }
  EXPECT_EQ(numbers_of(read_label_volume(write("a.tif", tiff_page(2, 2, 32, 1, 1, pack<std::uint32_t>(four))))), four);
  EXPECT_EQ(numbers_of(read_label_volume(write("a.tif", tiff_page(2, 2, 32, 1, 2, pack<std::int32_t>(four))))), four);
  EXPECT_EQ(numbers_of(read_label_volume(write("a.tif", tiff_page(2, 2, 64, 1, 1, pack<std::uint64_t>(four))))), four);
  EXPECT_EQ(numbers_of(read_label_volume(write("a.tif", tiff_page(2, 2, 32, 1, 3, pack<float>(four))))), four);
  expect_unreadable(write("a.tif", tiff_page(2, 2, 16, 1, 3, pack<std::uint16_t>(four))),
                    {"16 bits as floating point"});
  expect_unreadable(write("a.tif", tiff_page(50000, 50000, 8, 1, 1, pack<std::uint8_t>(four))), {"truncated"});
}

TEST_F(StoredNumbers, ASignInNamesIsToldFromAHyphenByTheOthers) {
  const auto order = [&](const std::string& folder, const std::vector<std::string>& names) {
    for (std::size_t i = 0; i < names.size(); ++i)
      write(folder + "/" + names[i] + ".png", grey_png(1, 1, {static_cast<int>(i) + 1}));
    std::vector<int> expected;
    for (std::size_t i = 0; i < names.size(); ++i) expected.push_back(static_cast<int>(i) + 1);
    EXPECT_EQ(numbers_of(read_label_volume(at(folder))), expected) << folder;
  };
  order("minus", {"z-100", "z-30", "z-5", "z0", "z5", "z25"});
  order("both", {"slice-20", "slice-5", "slice+5", "slice+20"});
  order("bare", {"-2", "-1", "0", "1", "10"});
  order("suffix", {"z-30_mask", "z-5_mask", "z0_mask", "z10_mask"});
  order("points", {"z-2.5", "z-2.25", "z-1.0", "z0.0", "z1.25", "z1.5"});
  order("hyphens", {"scan-1", "scan-2", "scan-10"});
  order("dates", {"2020-01-02-1", "2020-01-02-3", "2020-01-10-2", "2021-01-01-1"});
  for (const char* name : {"m/z-4.png", "m/z-2.png", "m/z2.png", "m/z4.png"}) write(name, grey_png(1, 1, {1}));
  EXPECT_TRUE(has_warning(read_label_volume(at("m")).warnings, "missing slice number 0"));
}

TEST_F(StoredNumbers, ParcelsAreToldFromIntensities) {
  const auto volume = [&](int edge, bool noise) {
    std::vector<std::uint16_t> values(std::size_t{32} * 32 * 32);
    for (int z = 0; z < 32; ++z)
      for (int y = 0; y < 32; ++y)
        for (int x = 0; x < 32; ++x) {
          const int parcel = 1 + x / edge + 16 * (y / edge) + 256 * (z / edge);
          values[(z * 32 + y) * 32 + x] =
              static_cast<std::uint16_t>(noise ? 1 + (x * 7919 + y * 104729 + z * 1299709) % 3000 : parcel);
        }
    return write("v.nrrd", nrrd("uint16", lps_grid, pack<std::uint16_t>(values), "32 32 32"));
  };
  EXPECT_GT(read_label_volume(volume(2, false)).labels.size(), 4000u);
  expect_unreadable(volume(2, true), {"intensity image", "1000 distinct"});
}

}  // namespace
