#pragma once
// Reading DICOM data sets with DCMTK: internal to the module, the only header here that shows it. No value that
// could identify a patient is ever put into a message: errors name fields and files only.
#include <dcmtk/config/osconfig.h>
#include <dcmtk/dcmdata/dctk.h>

#include <optional>
#include <string>
#include <vector>

#include "model/geometry.h"

namespace stackmesh {

/// Loads a whole data set; long values stay in the file until they are requested. Texts are turned to UTF-8.
/// @throws Error(input) when it cannot be opened, is no DICOM file, is damaged or ends early.
std::unique_ptr<DcmFileFormat> load_dicom(const std::string& path);

/// Loads what comes before the pixel data; nothing is thrown: null when it cannot be read.
std::unique_ptr<DcmFileFormat> load_dicom_header(const std::string& path);

/// The items of a sequence; empty when the item has none.
std::vector<DcmItem*> items_of(DcmItem& item, const DcmTagKey& sequence);
/// The first item of a sequence, null when there is none.
DcmItem* first_item(DcmItem& item, const DcmTagKey& sequence);

/// A text without blanks at its ends, valid UTF-8 without control signs; "" when absent.
std::string text_of(DcmItem& item, const DcmTagKey& tag);
/// All numbers of a decimal, integer or floating point field; empty when absent. @throws Error(input) naming field and
/// place when it holds anything else.
std::vector<double> numbers_of(DcmItem& item, const DcmTagKey& tag, const std::string& where);
std::optional<double> number_of(DcmItem& item, const DcmTagKey& tag, const std::string& where);
/// Three numbers. @throws Error(input)
std::optional<Vec3> vector_of(DcmItem& item, const DcmTagKey& tag, const std::string& where);

/// "JPEG 2000 (1.2.840.10008.1.2.4.90)": how the data set's pixels are stored.
std::string transfer_syntax_of(DcmFileFormat& file);

}  // namespace stackmesh
