// Abaqus and CalculiX decks, and Medit's text files.
#include <algorithm>
#include <unordered_map>

#include "base/text.h"
#include "meshio/raw_mesh.h"

namespace stackmesh {
namespace {

constexpr std::int64_t kLargestNumber = std::int64_t{1} << 53;  // ranges up to here can be walked without an overflow

/// VTK's type of an Abaqus element; 0: one that carries no geometry for us (lines, springs, masses).
int vtk_type_of(const std::string& type) {
  const auto begins = [&](const char* with) { return type.rfind(with, 0) == 0; };
  if (begins("c3d10") || begins("dc3d10")) return vtk_cell::quadratic_tet;
  if (begins("c3d4") || begins("dc3d4")) return vtk_cell::tet;
  if (begins("c3d8") || begins("dc3d8") || begins("c3d20") || begins("dc3d20") || begins("c3d27")) return 12;
  if (begins("c3d6") || begins("dc3d6") || begins("sc6")) return vtk_cell::wedge;
  if (begins("c3d15") || begins("dc3d15")) return vtk_cell::quadratic_wedge;
  if (begins("c3d5")) return vtk_cell::pyramid;
  if (begins("sc8")) return 12;
  if (begins("stri3") || begins("s3") || begins("m3d3") || begins("sfm3d3") || begins("r3d3") || begins("cps3") ||
      begins("cpe3") || begins("ds3") || begins("dc2d3"))
    return vtk_cell::triangle;
  if (begins("stri65") || begins("s6") || begins("m3d6") || begins("sfm3d6") || begins("cps6") || begins("cpe6"))
    return vtk_cell::quadratic_triangle;
  if (begins("s4") || begins("m3d4") || begins("sfm3d4") || begins("r3d4") || begins("cps4") || begins("cpe4") ||
      begins("ds4") || begins("dc2d4"))
    return vtk_cell::quad;
  if (begins("s8") || begins("m3d8") || begins("cps8") || begins("cpe8")) return vtk_cell::quadratic_quad;
  return 0;
}

std::size_t node_count(int vtk_type) {
  using namespace vtk_cell;
  if (vtk_type == wedge || vtk_type == pyramid) return vtk_type == wedge ? 6 : 5;
  if (vtk_type == quadratic_wedge) return 15;
  return vtk_type == tet || vtk_type == quad ? 4
         : vtk_type == triangle              ? 3
         : vtk_type == quadratic_tet         ? 10
         : vtk_type == quadratic_triangle    ? 6
                                             : 8;
}

class DeckReader {
 public:
  DeckReader(MeshBytes& in, RawMesh& mesh) : in_(in), mesh_(mesh) {}

  void run() {
    std::string_view text;
    while (in_.line(text)) {
      text = trimmed(text);
      if (text.empty()) continue;
      if (text.rfind("**", 0) == 0) comment(text);
      else if (text[0] == '*') keyword(text);
      else data(text);
    }
    end_block();
    if (!any_keyword_) in_.fail("the file has no keyword of Abaqus");
    choose_sets();
  }

 private:
  enum class Block { none, nodes, elements, element_set };

  void comment(std::string_view text) {
    mesh_.note_space(text);
    // "** label 5: femur", as our decks have it before the elements of a label
    const std::string lower = lower_case(text);
    const std::size_t at = lower.find("label "), colon = lower.find(':');
    told_ = std::nullopt;
    if (at == std::string::npos || colon == std::string::npos || colon < at) return;
    if (const auto number = to_integer(trimmed(text.substr(at + 6, colon - at - 6))))
      told_ = {{*number, std::string(trimmed(text.substr(colon + 1)))}};
  }

  static std::string parameter(const std::string& line, std::string_view original, const std::string& name) {
    for (std::size_t at = line.find(','); at != std::string::npos; at = line.find(',', at + 1)) {
      const std::size_t stop = std::min(line.find(',', at + 1), line.size()), equals = line.find('=', at);
      if (equals == std::string::npos || equals > stop) continue;
      if (trimmed(std::string_view(line).substr(at + 1, equals - at - 1)) != name) continue;
      std::string_view value = trimmed(original.substr(equals + 1, stop - equals - 1));
      if (value.size() >= 2 && value.front() == '"') value = value.substr(1, value.size() - 2);
      return std::string(value);
    }
    return "";
  }

  void keyword(std::string_view text) {
    end_block();
    any_keyword_ = true;
    const std::string line = lower_case(text);
    const std::string word(trimmed(std::string_view(line).substr(0, line.find(','))));
    block_ = Block::none;
    if (word == "*include" || !parameter(line, text, "input").empty())
      in_.fail_plainly("the deck includes another file", "write the mesh as one file");
    if (word == "*part" && ++parts_ > 1)
      in_.fail_plainly("the deck has several parts", "write it flat, without parts and instances");
    if (word == "*node") {
      block_ = Block::nodes;
    } else if (word == "*element") {
      block_ = Block::elements;
      const std::string type = lower_case(parameter(line, text, "type")), set = parameter(line, text, "elset");
      type_ = vtk_type_of(type);
      set_ = set.empty() ? -1 : set_number(set);
      if (told_ && set_ >= 0) sets_[set_].number = told_->first, sets_[set_].name = told_->second;
      told_ = std::nullopt;
    } else if (word == "*elset") {
      block_ = Block::element_set;
      set_ = set_number(parameter(line, text, "elset"));
      generate_ = line.find("generate") != std::string::npos;
    } else if (word.find("section") != std::string::npos) {
      const std::string set = parameter(line, text, "elset");
      if (!set.empty()) sections_.push_back(lower_case(set));
    }
  }

  std::int32_t set_number(const std::string& name) {
    const auto [it, is_new] = set_of_name_.emplace(lower_case(name), static_cast<std::int32_t>(sets_.size()));
    if (is_new) sets_.push_back({name, std::nullopt, {}});
    return it->second;
  }

  void data(std::string_view text) {
    if (block_ == Block::none) return;
    fields_.clear();
    while (!text.empty()) {
      const std::size_t comma = std::min(text.find(','), text.size());
      const std::string_view field = trimmed(text.substr(0, comma));
      if (!field.empty() || comma < text.size()) fields_.push_back(field);
      text = comma < text.size() ? text.substr(comma + 1) : std::string_view();
    }
    if (block_ == Block::nodes) node();
    else if (block_ == Block::elements) element();
    else if (block_ == Block::element_set) member();
  }

  std::int64_t whole(std::string_view field, const char* what) const {
    const auto n = to_integer(field);
    if (!n) in_.fail(std::string("a ") + what + " that is not a whole number");
    if (*n > kLargestNumber || *n < -kLargestNumber) in_.fail(std::string("a ") + what + " that is too large");
    return *n;
  }

  void node() {
    if (fields_.size() < 4) in_.fail("a node without three coordinates");
    double p[3];
    for (int k = 0; k < 3; ++k) {
      std::string text(fields_[k + 1]);
      for (char& c : text)
        if (c == 'd' || c == 'D') c = 'e';
      const auto v = text.empty() ? std::optional<double>(0) : to_number(text);
      if (!v) in_.fail("a node with a coordinate that is not a number");
      p[k] = *v;
    }
    const std::int64_t id = whole(fields_[0], "node number");
    if (!node_of_.emplace(id, static_cast<std::int64_t>(mesh_.points.size())).second)
      in_.fail("node " + std::to_string(id) + " is there twice");
    mesh_.points.push_back({p[0], p[1], p[2]});
  }

  /// An element may go on over lines.
  void element() {
    if (type_ == 0) return;
    for (const std::string_view f : fields_)
      if (!f.empty()) open_.push_back(whole(f, "number of an element"));
    const std::size_t nodes = type_ == 12 ? 0 : node_count(type_);
    if (nodes == 0) {
      if (open_.size() >= 2) mesh_.add_cell(type_, open_.data() + 1, open_.size() - 1), add_id();
      open_.clear();
      return;
    }
    if (open_.size() < nodes + 1) return;
    if (open_.size() > nodes + 1) in_.fail("element " + std::to_string(open_[0]) + " has too many nodes");
    for (std::size_t k = 1; k < open_.size(); ++k) {
      const auto it = node_of_.find(open_[k]);
      open_[k] = it == node_of_.end() ? -1 : it->second;
    }
    mesh_.add_cell(type_, open_.data() + 1, nodes);
    add_id();
    open_.clear();
  }

  void add_id() {
    element_set_.push_back(set_);
    element_of_.emplace(open_[0], mesh_.cells - 1);
  }

  void member() {
    if (generate_) {
      if (fields_.size() < 2) in_.fail("a range of elements without its end");
      const std::int64_t from = whole(fields_[0], "number of an element"),
                         to = whole(fields_[1], "number of an element");
      const std::int64_t step = fields_.size() > 2 && !fields_[2].empty() ? whole(fields_[2], "step") : 1;
      if (step < 1 || from > to) in_.fail("an odd range of elements");
      sets_[set_].ranges.push_back({from, to, step});
      return;
    }
    for (const std::string_view f : fields_) {
      if (f.empty()) continue;
      const auto id = to_integer(f);
      if (!id) {  // the name of another set
        sets_[set_].members.push_back(lower_case(f));
        continue;
      }
      whole(f, "number of an element");
      sets_[set_].ranges.push_back({*id, *id, 1});
    }
  }

  void end_block() {
    if (!open_.empty()) in_.fail("element " + std::to_string(open_[0]) + " has too few nodes");
  }

  /// The sets that stand for labels: those of sections; else those that *ELEMENT names; else *ELSETs, the first that
  /// holds an element.
  void choose_sets() {
    std::vector<std::int32_t> of_cell(element_set_);
    const auto fill = [&](std::int32_t set, bool override_others) {
      const auto put = [&](std::int64_t cell) {
        if (of_cell[cell] < 0 || override_others) of_cell[cell] = set;
      };
      const auto fill_one = [&](const DeckSet& s) {
        for (const auto& r : s.ranges) {
          const std::int64_t length = (r.to - r.from) / r.step + 1;
          // a range with holes: look at what is there
          if (length > static_cast<std::int64_t>(2 * element_of_.size() + 16)) {
            for (const auto& [id, cell] : element_of_)
              if (id >= r.from && id <= r.to && (id - r.from) % r.step == 0) put(cell);
            continue;
          }
          for (std::int64_t id = r.from; id <= r.to; id += r.step)
            if (const auto it = element_of_.find(id); it != element_of_.end()) put(it->second);
        }
      };
      fill_one(sets_[set]);
      for (std::size_t c = 0; c < of_cell.size(); ++c)
        if (element_set_[c] == set) put(static_cast<std::int64_t>(c));
      for (const std::string& other : sets_[set].members)
        if (const auto it = set_of_name_.find(other); it != set_of_name_.end()) {
          fill_one(sets_[it->second]);
          for (std::size_t c = 0; c < of_cell.size(); ++c)
            if (element_set_[c] == it->second) put(static_cast<std::int64_t>(c));
        }
    };
    std::vector<std::int32_t> by_section;
    for (const std::string& name : sections_)
      if (const auto it = set_of_name_.find(name); it != set_of_name_.end()) by_section.push_back(it->second);
    std::sort(by_section.begin(), by_section.end());
    by_section.erase(std::unique(by_section.begin(), by_section.end()), by_section.end());
    std::vector<std::int32_t> by_element(element_set_);
    std::sort(by_element.begin(), by_element.end());
    by_element.erase(std::unique(by_element.begin(), by_element.end()), by_element.end());
    const bool all_named = by_element.size() > 1 && by_element[0] >= 0;  // several sets, and no element without
    if (by_section.size() > 1 && !all_named) {
      for (const std::int32_t s : by_section) fill(s, true);
    } else if (!all_named) {
      std::vector<std::int32_t> kept = of_cell;
      std::fill(of_cell.begin(), of_cell.end(), -1);
      for (std::size_t s = 0; s < sets_.size(); ++s)
        if (lower_case(sets_[s].name) != "eall" && !(sets_[s].ranges.empty() && sets_[s].members.empty()))
          fill(static_cast<std::int32_t>(s), false);
      for (std::size_t c = 0; c < of_cell.size(); ++c)
        if (of_cell[c] < 0) of_cell[c] = kept[c];
    }
    for (const DeckSet& s : sets_) {
      RawMesh::Set out;
      out.name = s.name;
      out.number = s.number;
      mesh_.sets.push_back(std::move(out));
    }
    mesh_.set_of_cell = std::move(of_cell);
  }

  struct Range {
    std::int64_t from, to, step;
  };
  struct DeckSet {
    std::string name;
    std::optional<std::int64_t> number;
    std::vector<Range> ranges;
    std::vector<std::string> members = {};
  };
  MeshBytes& in_;
  RawMesh& mesh_;
  Block block_ = Block::none;
  int type_ = 0, parts_ = 0;
  std::int32_t set_ = -1;
  bool generate_ = false, any_keyword_ = false;
  std::optional<std::pair<std::int64_t, std::string>> told_;
  std::vector<std::string_view> fields_;
  std::vector<std::int64_t> open_;
  std::vector<DeckSet> sets_;
  std::map<std::string, std::int32_t, std::less<>> set_of_name_;
  std::vector<std::string> sections_;
  std::vector<std::int32_t> element_set_;  // per cell
  std::unordered_map<std::int64_t, std::int64_t> node_of_, element_of_;
};

}  // namespace

void read_inp(MeshBytes& in, RawMesh& mesh) {
  DeckReader(in, mesh).run();
}

void read_medit(MeshBytes& in, RawMesh& mesh) {
  const std::string_view all = in.rest();
  for (std::size_t at = all.find('#'); at != std::string_view::npos && at < 4096; at = all.find('#', at + 1))
    mesh.note_space(all.substr(at, std::min(all.find('\n', at), all.size()) - at));
  if (lower_case(in.word('#')) != "meshversionformatted") in.fail("the file does not begin with MeshVersionFormatted");
  in.integer("a version", '#');
  std::vector<double> refs;
  const auto cells = [&](int type, int nodes, bool other = false) {
    const std::size_t n = in.count(in.integer("a count", '#'), 2 * static_cast<std::size_t>(nodes + 1) - 1, "elements");
    std::int64_t corners[32];
    for (std::size_t i = 0; i < n; ++i) {
      for (int k = 0; k < nodes; ++k) corners[k] = in.integer("a corner", '#') - 1;
      const std::int64_t ref = in.integer("a reference", '#');
      if (other) continue;
      mesh.add_cell(type, corners, static_cast<std::size_t>(nodes));
      refs.push_back(static_cast<double>(ref));
    }
  };
  bool dimension = false;
  for (std::string key = lower_case(in.word('#')); !key.empty() && key != "end"; key = lower_case(in.word('#'))) {
    if (key == "dimension") {
      if (in.integer("a dimension", '#') != 3) in.fail("only meshes of dimension 3 are read");
      dimension = true;
    } else if (key == "vertices") {
      const std::size_t n = in.count(in.integer("a count of points", '#'), 7, "points");
      for (std::size_t i = 0; i < n; ++i) {
        Vec3 p;
        p.x = in.number("a coordinate", '#'), p.y = in.number("a coordinate", '#'),
        p.z = in.number("a coordinate", '#');
        in.integer("a reference", '#');
        mesh.points.push_back(p);
      }
    } else if (key == "triangles") {
      cells(vtk_cell::triangle, 3);
    } else if (key == "tetrahedra") {
      cells(vtk_cell::tet, 4);
    } else if (key == "quadrilaterals") {
      cells(vtk_cell::quad, 4);
    } else if (key == "hexahedra") {
      cells(12, 8);
    } else if (key == "prisms") {
      cells(13, 6);
    } else if (key == "edges") {
      cells(vtk_cell::line, 2, true);
    } else if (key == "corners" || key == "requiredvertices" || key == "ridges" || key == "requirededges" ||
               key == "requiredtriangles") {
      const std::size_t n = in.count(in.integer("a count", '#'), 2, "entries");
      for (std::size_t i = 0; i < n; ++i) in.integer("an entry", '#');
    } else {
      in.fail("an unknown section of a Medit file");
    }
  }
  if (!dimension) in.fail("the file tells no dimension");
  mesh.arrays.push_back({"medit:ref", std::move(refs)});
}

}  // namespace stackmesh
