#include "image/dicom_dataset.h"

#include <dcmtk/dcmdata/dcdeftag.h>
#include <dcmtk/dcmdata/dcxfer.h>
#include <dcmtk/oflog/oflog.h>
#include <sys/stat.h>

#include <charconv>
#include <cmath>
#include <cstring>
#include <fstream>

#include "base/error.h"
#include "image/dicom_file.h"
#include "image/dicom_nesting.h"
#include "image/dicom_text.h"

namespace stackmesh {
namespace {

constexpr const char* again = "copy or export the file again";

/// DCMTK would log to stderr.
void silence() {
  static const bool done = [] {
    OFLog::configure(OFLogger::OFF_LOG_LEVEL);
    // Values of more than 64 kB do not fit explicit VRs such as DS and are stored as UN (PS3.5, 6.2.2): read by the
    // dictionary.
    dcmEnableUnknownVRConversion.set(OFTrue);
    return true;
  }();
  (void)done;
}

/// Valid UTF-8 without control signs: what is not becomes '?'.
std::string clean(const std::string& text) {
  std::string out;
  for (std::size_t i = 0; i < text.size();) {
    const auto u = static_cast<unsigned char>(text[i]);
    const std::size_t length = u < 0x80                ? 1
                               : u >= 0xc2 && u < 0xe0 ? 2
                               : u >= 0xe0 && u < 0xf0 ? 3
                               : u >= 0xf0 && u < 0xf5 ? 4
                                                       : 0;
    bool good = length > 0 && i + length <= text.size() && u >= 0x20 && u != 0x7f;
    for (std::size_t k = 1; good && k < length; ++k) good = (static_cast<unsigned char>(text[i + k]) & 0xc0) == 0x80;
    if (good) out += text.substr(i, length);
    else out += '?';
    i += good ? length : 1;
  }
  const std::size_t a = out.find_first_not_of(' '), b = out.find_last_not_of(' ');
  return a == std::string::npos ? "" : out.substr(a, b - a + 1);
}

/// Specific Character Set of an item, or of what it lies in; all of its values.
std::string character_sets_of(DcmItem& item) {
  for (DcmItem* at = &item; at != nullptr; at = at->getParentItem()) {
    OFString sets;
    if (at->findAndGetOFStringArray(DCM_SpecificCharacterSet, sets).good() && !sets.empty()) return sets.c_str();
  }
  return "";
}

std::string field_name(const DcmTagKey& key) {
  DcmTag tag(key);
  return std::string(tag.getTagName()) + " " + key.toString().c_str();
}

}  // namespace

std::unique_ptr<DcmFileFormat> load_dicom(const std::string& path) {
  silence();
  std::ifstream probe(path, std::ios::binary);
  if (!probe) fail_input("cannot open the file", path, "check that you may read it");
  if (dicom_nesting(path) > kDeepest)
    fail_input("the DICOM file's sequences are nested more than " + std::to_string(kDeepest) + " deep", path, again);
  auto file = std::make_unique<DcmFileFormat>();
  const OFCondition status = file->loadFile(path.c_str());
  if (status.bad()) fail_input("the DICOM file is damaged or truncated", path, again);
  if (file->getDataset() == nullptr || file->getDataset()->card() == 0)
    fail_input("this is no DICOM file, or it is damaged", path, again);
  // Code extensions are text_of()'s; where the conversion fails, clean() sees to it.
  if (!needs_code_extensions(character_sets_of(*file->getDataset()))) file->getDataset()->convertToUTF8();
  return file;
}

std::unique_ptr<DcmFileFormat> load_dicom_header(const std::string& path) {
  silence();
  if (dicom_nesting(path) > kDeepest) return nullptr;
  auto file = std::make_unique<DcmFileFormat>();
  const OFCondition status =
      file->loadFileUntilTag(path.c_str(), EXS_Unknown, EGL_noChange, 4096, ERM_autoDetect, DCM_PixelData);
  if (status.bad() || file->getDataset() == nullptr || file->getDataset()->card() == 0) return nullptr;
  return file;
}

std::vector<DcmItem*> items_of(DcmItem& item, const DcmTagKey& sequence) {
  std::vector<DcmItem*> items;
  DcmSequenceOfItems* found = nullptr;
  if (item.findAndGetSequence(sequence, found).bad() || found == nullptr) return items;
  for (DcmObject* o = found->nextInContainer(nullptr); o != nullptr; o = found->nextInContainer(o))
    if (auto* i = dynamic_cast<DcmItem*>(o)) items.push_back(i);
  return items;
}

DcmItem* first_item(DcmItem& item, const DcmTagKey& sequence) {
  const std::vector<DcmItem*> items = items_of(item, sequence);
  return items.empty() ? nullptr : items[0];
}

std::string text_of(DcmItem& item, const DcmTagKey& tag) {
  OFString value;
  const std::string sets = character_sets_of(item);
  if (needs_code_extensions(sets))
    return item.findAndGetOFStringArray(tag, value).good() ? clean(decode_dicom_text(value.c_str(), sets)) : "";
  if (item.findAndGetOFString(tag, value).bad()) return "";
  return clean(value.c_str());
}

std::vector<double> numbers_of(DcmItem& item, const DcmTagKey& tag, const std::string& where) {
  std::vector<double> numbers;
  DcmElement* element = nullptr;
  if (item.findAndGetElement(tag, element).bad() || element == nullptr) return numbers;
  const auto refuse = [&] {
    fail_input("the field " + field_name(tag) + " holds no finite numbers, or is of the wrong kind (VR)", where, again);
  };
  if (element->getLength() == 0) return numbers;
  switch (element->ident()) {
    case EVR_US:
    case EVR_SS:
    case EVR_UL:
    case EVR_SL:
    case EVR_FD:
    case EVR_FL:
    case EVR_xs:
      for (unsigned long i = 0; i < element->getVM(); ++i) {
        double value = 0;
        Uint16 u = 0;
        Sint16 s = 0;
        Uint32 ul = 0;
        Sint32 sl = 0;
        Float32 fl = 0;
        if (element->getFloat64(value, i).bad()) {
          if (element->getUint16(u, i).good()) value = u;
          else if (element->getSint16(s, i).good()) value = s;
          else if (element->getUint32(ul, i).good()) value = ul;
          else if (element->getSint32(sl, i).good()) value = sl;
          else if (element->getFloat32(fl, i).good()) value = fl;
          else refuse();
        }
        if (!std::isfinite(value)) refuse();
        numbers.push_back(value);
      }
      return numbers;
    default:
      break;
  }
  OFString joined;
  if (element->getOFStringArray(joined, OFFalse).bad() || element->isaString() == OFFalse) refuse();
  const char *at = joined.c_str(), *const end = at + joined.length();
  while (at < end) {
    while (at < end && (*at == ' ' || *at == '+')) ++at;
    double value = 0;
    const auto [stop, error] = std::from_chars(at, end, value);
    if (error != std::errc() || !std::isfinite(value)) refuse();
    numbers.push_back(value);
    at = stop;
    while (at < end && (*at == ' ' || *at == '\0')) ++at;
    if (at < end && *at++ != '\\') refuse();
  }
  return numbers;
}

std::optional<double> number_of(DcmItem& item, const DcmTagKey& tag, const std::string& where) {
  const std::vector<double> n = numbers_of(item, tag, where);
  return n.empty() ? std::nullopt : std::make_optional(n[0]);
}

std::optional<Vec3> vector_of(DcmItem& item, const DcmTagKey& tag, const std::string& where) {
  const std::vector<double> n = numbers_of(item, tag, where);
  if (n.empty()) return std::nullopt;
  if (n.size() != 3)
    fail_input("the field " + field_name(tag) + " holds " + std::to_string(n.size()) + " numbers in place of 3", where,
               again);
  return Vec3{n[0], n[1], n[2]};
}

std::string transfer_syntax_of(DcmFileFormat& file) {
  const DcmXfer xfer(file.getDataset()->getOriginalXfer());
  return std::string(xfer.getXferName()) + " (" + xfer.getXferID() + ")";
}

void refuse_dicom(const std::string& path) {
  load_dicom(path);  // damaged?
  fail_input("this DICOM file holds no image, segmentation or structure set", path,
             "give a SEG, an RTSTRUCT, or the folder of a series");
}

DicomKind dicom_kind(const std::string& path) {
  struct stat info;
  if (::stat(path.c_str(), &info) != 0 || !S_ISREG(info.st_mode)) return DicomKind::none;
  char start[132] = {};
  std::ifstream stream(path, std::ios::binary);
  stream.read(start, sizeof start);
  const bool marked = stream.gcount() == sizeof start && std::memcmp(start + 128, "DICM", 4) == 0;
  // Old programs write the data set alone, which begins with group 2 or 8.
  const bool bare = stream.gcount() > 8 && (start[0] == 8 || start[0] == 2) && start[1] == 0 && start[3] == 0;
  if (!marked && !bare) return DicomKind::none;
  const auto file = load_dicom_header(path);
  if (file == nullptr) return marked ? DicomKind::other : DicomKind::none;
  DcmDataset& data = *file->getDataset();
  const std::string modality = text_of(data, DCM_Modality);
  const std::string uid = text_of(data, DCM_SOPClassUID);
  if (uid == UID_RTStructureSetStorage || modality == "RTSTRUCT") return DicomKind::structure_set;
  if (uid == UID_SegmentationStorage || uid == "1.2.840.10008.5.1.4.1.1.66.7" || (uid.empty() && modality == "SEG"))
    return DicomKind::segmentation;
  if (data.tagExists(DCM_Rows) && data.tagExists(DCM_Columns)) return DicomKind::image;
  return DicomKind::other;
}

}  // namespace stackmesh
