#include "slicer_module.h"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <mutex>

#include "base/atomic_file.h"
#include "base/error.h"

namespace stackmesh::app {
namespace {

enum class Kind { text, number, whole, flag };

/// One parameter of the module: an option of `mesh` by the same name.
struct Parameter {
  const char *group, *name, *option, *label, *description, *initial;
  Kind kind;
};

// Grouped as Slicer's panel shows them.
constexpr const char* kLabels = "Labels";
constexpr const char* kSurface = "Surface";
constexpr const char* kVolume = "Tetrahedra";
constexpr Parameter kParameters[] = {
    {kLabels, "label", "--label", "Labels", "Labels to mesh, by number or name: 1,4,7-9,heart. Empty: all.", "",
     Kind::text},
    {kLabels, "merge", "--merge", "Merge", "The selected labels become one.", "false", Kind::flag},
    {kLabels, "caps", "--caps", "Ends", "How labels end: auto, flat or round; per label 5=flat,9=round.", "auto",
     Kind::text},
    {kLabels, "axis", "--axis", "Stacking axis", "auto (the coarsest spacing), x, y or z.", "auto", Kind::text},
    {kSurface, "edgeLength", "--edge-length", "Edge length",
     "Uniform edge length in mm, or per label 5=2.0,9=1.0. Empty: by curvature.", "", Kind::text},
    {kSurface, "deviation", "--deviation", "Deviation",
     "Sizing by curvature: largest distance to the curved surface, mm. 0: half a pixel.", "0", Kind::number},
    {kSurface, "gradation", "--gradation", "Gradation", "Largest ratio of neighbouring edge lengths.", "1.3",
     Kind::number},
    {kSurface, "smooth", "--smooth", "Smoothing passes", "0 is none.", "5", Kind::whole},
    {kSurface, "interpolate", "--interpolate", "Virtual sections",
     "Sections between far slices: auto, or a number per gap.", "auto", Kind::text},
    {kSurface, "noEnhance", "--no-enhance", "No enhancement", "The volume of the stitched surface as it is.", "false",
     Kind::flag},
    {kVolume, "maxVolume", "--max-volume", "Largest tetrahedron", "mm3. 0: graded from the surface.", "0",
     Kind::number},
    {kVolume, "threads", "--threads", "Threads", "0: all.", "0", Kind::whole}};

const char* tag_of(Kind kind) {
  switch (kind) {
    case Kind::number:
      return "double";
    case Kind::whole:
      return "integer";
    case Kind::flag:
      return "boolean";
    default:
      return "string";
  }
}

std::string escaped(const std::string& text) {
  std::string out;
  for (char c : text) out += c == '<' ? "&lt;" : c == '>' ? "&gt;" : c == '&' ? "&amp;" : std::string(1, c);
  return out;
}

std::string element(const std::string& tag, const std::string& text) {
  return "      <" + tag + ">" + escaped(text) + "</" + tag + ">\n";
}

bool starts_with(const std::string& text, const std::string& start) {
  return text.compare(0, start.size(), start) == 0;
}

const Parameter* find_parameter(const std::string& flag) {
  for (const Parameter& p : kParameters)
    if (flag == p.option || flag == std::string("--") + p.name) return &p;
  return nullptr;
}

/// "--flag=value" as two.
std::vector<std::string> split_flags(int argc, char** argv) {
  std::vector<std::string> words;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    const std::size_t equal = word.find('=');
    if (starts_with(word, "--") && equal != std::string::npos) {
      words.push_back(word.substr(0, equal));
      words.push_back(word.substr(equal + 1));
    } else {
      words.push_back(word);
    }
  }
  return words;
}

/// Where in the whole run a stage ends, about; a stage that comes again does not turn the bar back.
struct StageEnd {
  const char* stage;
  double end;
};
constexpr StageEnd kStages[] = {{"read", 0.05},   {"contours", 0.15}, {"stitch", 0.25}, {"validate", 0.3},
                                {"enhance", 0.7}, {"volume", 0.95},   {"write", 1}};

class SlicerProgress : public Monitor {
 public:
  void begin(const std::string& stage) override {
    const std::lock_guard<std::mutex> lock(mutex_);
    stage_ = stage;
    start_ = Clock::now();
    low_ = shown_;
    high_ = low_;
    for (const StageEnd& s : kStages)
      if (stage == s.stage && s.end > low_) high_ = s.end;
    std::printf(
        "<filter-start>\n<filter-name>%s</filter-name>\n<filter-comment>stackmesh</filter-comment>\n</filter-start>\n",
        stage.c_str());
    tell(low_);
  }
  void advance(double fraction) override {
    const std::lock_guard<std::mutex> lock(mutex_);
    const double done = low_ + (high_ - low_) * std::min(std::max(fraction, 0.0), 1.0);
    if (done >= shown_ + 0.005) tell(done);
  }
  void end() override {
    const std::lock_guard<std::mutex> lock(mutex_);
    tell(high_);
    std::printf("<filter-end>\n<filter-name>%s</filter-name>\n<filter-time>%.3f</filter-time>\n</filter-end>\n",
                stage_.c_str(), std::chrono::duration<double>(Clock::now() - start_).count());
    std::fflush(stdout);
  }

 private:
  using Clock = std::chrono::steady_clock;
  void tell(double done) {
    shown_ = std::max(shown_, done);
    std::printf("<filter-progress>%.3f</filter-progress>\n", shown_);
    std::fflush(stdout);
  }
  std::mutex mutex_;
  std::string stage_;
  Clock::time_point start_;
  double low_ = 0, high_ = 0, shown_ = 0;
};

}  // namespace

std::string slicer_description() {
  std::string xml =
      "<?xml version=\"1.0\" encoding=\"utf-8\"?>\n<executable>\n  <category>Segmentation</category>\n"
      "  <title>Tetrahedral mesh of labels (stackmesh)</title>\n"
      "  <description>Meshes every label of a label map with tetrahedra. Labels that touch share their faces, every "
      "surface is closed and free "
      "of self-intersections, and this is checked before the mesh is written.</description>\n"
      "  <version>" STACKMESH_VERSION
      "</version>\n  <documentation-url></documentation-url>\n  <license>AGPL-3.0-or-later</license>\n"
      "  <contributor></contributor>\n"
      "  <parameters>\n    <label>Input and output</label>\n    <description>What is meshed, and where the mesh "
      "goes.</description>\n"
      "    <image type=\"label\" fileExtensions=\".nrrd,.nii.gz,.nii,.mha\">\n";
  xml += element("name", "inputLabels") + element("label", "Label map") +
         element("description", "The labels to mesh; 0 is the background.") + element("channel", "input") +
         element("index", "0");
  xml += "    </image>\n    <geometry type=\"model\" fileExtensions=\".vtu,.vtk,.vtp,.stl,.ply,.obj\">\n";
  xml += element("name", "outputMesh") + element("label", "Mesh") +
         element("description",
                 "Tetrahedra (.vtu, .vtk) with their labels, or the surface (.vtp, .stl, .ply, .obj); LPS mm.") +
         element("channel", "output") + element("index", "1");
  xml += "    </geometry>\n  </parameters>\n";
  const char* group = nullptr;
  for (const Parameter& p : kParameters) {
    if (p.group != group) {
      if (group != nullptr) xml += "  </parameters>\n";
      xml += "  <parameters>\n    <label>" + std::string(p.group) + "</label>\n    <description>" + p.group +
             "</description>\n";
      group = p.group;
    }
    xml += "    <" + std::string(tag_of(p.kind)) + ">\n" + element("name", p.name) + element("longflag", p.option) +
           element("label", p.label) + element("description", p.description) + element("default", p.initial) +
           "    </" + tag_of(p.kind) + ">\n";
  }
  return xml + "  </parameters>\n</executable>\n";
}

bool is_slicer_call(int argc, char** argv) {
  if (argc < 3 || argv[1][0] != '-') {
    // Input and output alone are told from a command by Slicer's own flags only.
    for (int i = 1; i < argc; ++i)
      if (starts_with(argv[i], "--processinformationaddress") || starts_with(argv[i], "--returnparameterfile"))
        return true;
    return false;
  }
  return find_parameter(split_flags(argc, argv)[0]) != nullptr || starts_with(argv[1], "--processinformationaddress") ||
         starts_with(argv[1], "--returnparameterfile");
}

std::vector<std::string> translate_slicer_call(int argc, char** argv) {
  std::string return_parameters;
  std::vector<std::string> files, options;
  const std::vector<std::string> words = split_flags(argc, argv);
  for (std::size_t i = 0; i < words.size(); ++i) {
    const std::string& word = words[i];
    if (word.size() < 2 || word[0] != '-') {
      files.push_back(word);
      continue;
    }
    if (word == "--echo") continue;
    const Parameter* p = find_parameter(word);
    const bool slicers_own = word == "--processinformationaddress" || word == "--returnparameterfile";
    if (p == nullptr && !slicers_own)
      fail_usage("unknown flag '" + word + "'", "command line of a Slicer module", "see stackmesh --xml");
    if (p != nullptr && p->kind == Kind::flag) {
      options.push_back(p->option);
      continue;
    }
    if (++i == words.size())
      fail_usage("the flag " + word + " has no value", "command line of a Slicer module", "see stackmesh --xml");
    if (word == "--returnparameterfile") return_parameters = words[i];
    if (p == nullptr || words[i] == p->initial || words[i].empty()) continue;
    if (p->kind != Kind::text && std::strtod(words[i].c_str(), nullptr) == std::strtod(p->initial, nullptr)) continue;
    options.push_back(p->option);
    options.push_back(words[i]);
  }
  if (files.size() != 2)
    fail_usage(std::to_string(files.size()) + " files where an input and an output belong",
               "command line of a Slicer module", "see stackmesh --xml");
  std::vector<std::string> arguments = {"mesh", files[0], "-o", files[1], "--progress", "slicer"};
  if (!return_parameters.empty()) arguments.insert(arguments.end(), {"--return-parameters", return_parameters});
  arguments.insert(arguments.end(), options.begin(), options.end());
  return arguments;
}

std::unique_ptr<Monitor> make_slicer_progress() {
  return std::make_unique<SlicerProgress>();
}

void write_return_parameters(const std::string& path, const std::vector<std::pair<std::string, std::string>>& values) {
  AtomicFiles files;
  files.write(path, [&](std::FILE* file) {
    for (const auto& [name, value] : values) std::fprintf(file, "%s = %s\n", name.c_str(), value.c_str());
  });
  files.commit();
}

}  // namespace stackmesh::app
