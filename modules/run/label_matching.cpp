#include "run/label_matching.h"

#include <algorithm>
#include <map>
#include <set>
#include <string>
#include <utility>

#include "base/error.h"
#include "base/text.h"
#include "run/complete_report.h"

namespace stackmesh {
namespace {

/// Letters and digits only, in lower case: how decks and groups spell a name.
std::string plain(const std::string& name) {
  std::string text;
  for (const char c : lower_case(name))
    if ((c >= 'a' && c <= 'z') || (c >= '0' && c <= '9')) text += c;
  return text;
}

class LabelMatcher {
 public:
  LabelMatcher(MeshToJudge& mesh, const Against* against, RunReport& report)
      : m_(mesh), against_(against), report_(report) {}

  LabelMatch run() {
    match_labels();
    return std::move(out_);
  }

 private:
  void match_labels() {
    std::set<Label> of_mesh;
    for (const InterfaceTriangle& t : m_.surface.triangles) of_mesh.insert(t.below), of_mesh.insert(t.above);
    of_mesh.erase(0);
    if (!against_) {
      for (const Label l : of_mesh) {
        LabelReport row;
        row.label = l;
        for (const LabelInfo& n : m_.file.names)
          if (n.number == l) row.name = n.name;
        report_.labels.push_back(row);
      }
      report_.mesh->labels = source_text() + ": " + list(of_mesh);
      return;
    }
    out_.labels = against_->input.labels;
    std::map<Label, Label> to;  // label of the mesh to that of the input
    if (m_.file.label_source == LabelSource::none) single_surface(to);
    else if (m_.file.label_source == LabelSource::sets && m_.file.numbers_from_names) by_name(of_mesh, to);
    else by_number(of_mesh, to);
    std::string text = source_text();
    for (const auto& [from, target] : to)
      if (from != target && m_.file.label_source != LabelSource::none && to.size() < 12)
        text += ", " + std::to_string(from) + " stands for " + std::to_string(target);
    report_.mesh->labels = text + matched_;
    rename(to);
    add_label_rows(report_, out_.labels);
  }

  std::string source_text() const {
    switch (m_.file.label_source) {
      case LabelSource::none:
        return "no labels in the file";
      case LabelSource::sides:
        return "labels from " + m_.file.label_array;
      case LabelSource::array:
        return "labels from array '" + m_.file.label_array + "'";
      case LabelSource::sets:
        return "labels from sets";
    }
    return "";
  }

  static std::string list(const std::set<Label>& labels) {
    std::string text;
    std::size_t n = 0;
    for (const Label l : labels) {
      if (++n > 12) return text + " and " + std::to_string(labels.size() - 12) + " more";
      text += (n > 1 ? ", " : "") + std::to_string(l);
    }
    return text;
  }

  bool asked(Label label) const {
    return std::any_of(out_.labels.begin(), out_.labels.end(), [&](const LabelInfo& l) { return l.number == label; });
  }
  void keep_only(Label label) {
    out_.labels.erase(
        std::remove_if(out_.labels.begin(), out_.labels.end(), [&](const LabelInfo& l) { return l.number != label; }),
        out_.labels.end());
  }

  /// No labels in the file: it stands for the only label that is requested, the one that it fits best, or all together.
  void single_surface(std::map<Label, Label>& to) {
    if (out_.labels.size() == 1) {
      to[1] = out_.labels[0].number;
      matched_ = ", it stands for label " + std::to_string(to[1]);
      return;
    }
    if (!against_->meter)
      fail_input("the mesh has one surface and the contours have " + std::to_string(out_.labels.size()) + " labels",
                 m_.file.path, "say which with --label");
    const LabelOverlap o = against_->meter->measure(m_.surface);
    std::size_t best = 1;
    for (std::size_t l = 2; l < o.input_centres.size(); ++l)
      if (o.dice(0, l) > o.dice(0, best)) best = l;
    const double one = o.dice(0, best), all = o.dice_of_all();
    if (all > one) {
      out_.united = true;
      to[1] = out_.labels[0].number;
      matched_ = ", it stands for all labels together (Dice " + three_decimals(all) + "; best single label " +
                 std::to_string(out_.labels[best - 1].number) + ": " + three_decimals(one) + ")";
    } else {
      to[1] = out_.labels[best - 1].number;
      matched_ = ", it fits label " + std::to_string(to[1]) + " best (Dice " + three_decimals(one) + "; all together " +
                 three_decimals(all) + ")";
    }
    warn({WarningCode::labels_matched, m_.file.path,
          "the mesh has one surface and the input " + std::to_string(out_.labels.size()) + " labels" + matched_ +
              "; --label tells which"});
    if (!out_.united) keep_only(to[1]);
  }

  void by_number(const std::set<Label>& of_mesh, std::map<Label, Label>& to) {
    std::set<Label> shared, unknown;
    for (const Label l : of_mesh) (asked(l) ? shared : unknown).insert(l);
    if (shared.empty()) {
      by_overlap(of_mesh, to, "no label number of the mesh (" + list(of_mesh) + ") is one of the input");
      return;
    }
    for (const Label l : of_mesh) to[l] = asked(l) ? l : 0;
    forget(unknown);
    if (of_mesh.size() == 1 && out_.labels.size() > 1) {
      warn({WarningCode::labels_matched, m_.file.path,
            "the mesh has label " + list(of_mesh) + " alone: only that label is judged"});
      keep_only(*of_mesh.begin());
    }
  }

  /// Labels of the mesh that the input does not have, or that were not requested, are background.
  void forget(const std::set<Label>& unknown) {
    if (!unknown.empty())
      warn({WarningCode::labels_matched, m_.file.path,
            "labels of the mesh that are not requested or not in the input are taken as background: " + list(unknown)});
  }

  void by_name(const std::set<Label>& of_mesh, std::map<Label, Label>& to) {
    std::map<std::string, Label> known;
    for (const LabelInfo& l : out_.labels) {
      if (!l.name.empty()) known[plain(l.name)] = l.number;
      known.emplace(plain("label_" + std::to_string(l.number)), l.number);
    }
    std::set<Label> unknown;
    for (const LabelInfo& n : m_.file.names) {
      const auto it = known.find(plain(n.name));
      if (it != known.end()) to[n.number] = it->second;
    }
    for (const Label l : of_mesh)
      if (!to.count(l)) unknown.insert(l);
    if (unknown.size() == of_mesh.size()) {
      to.clear();
      by_overlap(of_mesh, to, "no set of the mesh has the name of a label of the input");
      return;
    }
    for (const Label l : unknown) to[l] = 0;
    forget(unknown);
  }

  /// Each label of the mesh stands for the one that it covers best.
  void by_overlap(const std::set<Label>& of_mesh, std::map<Label, Label>& to, const std::string& why) {
    if (!against_->meter) fail_input(why, m_.file.path, "renumber the labels of the mesh");
    const LabelOverlap o = against_->meter->measure(m_.surface);
    std::string text;
    for (std::size_t m = 0; m < o.mesh_labels.size(); ++m) {
      std::size_t best = 1;
      for (std::size_t l = 2; l < o.input_centres.size(); ++l)
        if (o.dice(m, l) > o.dice(m, best)) best = l;
      const Label target = o.dice(m, best) > 0 ? out_.labels[best - 1].number : 0;
      to[o.mesh_labels[m]] = target;
      if (m < 12)
        text += (m ? ", " : "") + std::to_string(o.mesh_labels[m]) + " as " + std::to_string(target) + " (Dice " +
                three_decimals(o.dice(m, best)) + ")";
    }
    warn({WarningCode::labels_matched, m_.file.path,
          why + ": its labels are taken for those that they overlap best: " + text});
    if (of_mesh.size() == 1 && out_.labels.size() > 1 && to.begin()->second != 0) keep_only(to.begin()->second);
  }

  void rename(const std::map<Label, Label>& to) {
    const auto of = [&](Label l) {
      const auto it = to.find(l);
      return it == to.end() ? 0 : it->second;
    };
    const auto apply = [&](std::vector<InterfaceTriangle>& triangles) {
      for (InterfaceTriangle& t : triangles) t.below = of(t.below), t.above = of(t.above);
      triangles.erase(std::remove_if(triangles.begin(), triangles.end(),
                                     [](const InterfaceTriangle& t) { return t.below == t.above; }),
                      triangles.end());
    };
    const bool same = std::all_of(to.begin(), to.end(), [](const auto& p) { return p.first == p.second; });
    if (same) return;
    apply(m_.surface.triangles);
    if (m_.tets.elements() == 0) return;
    apply(m_.tets.faces);
    relabel(m_.tets, of);
  }

  void warn(Warning w) { report_.warnings.push_back(std::move(w)); }

  MeshToJudge& m_;
  const Against* against_;
  RunReport& report_;
  LabelMatch out_;
  std::string matched_;  // how a mesh without labels was matched, for the report
};

}  // namespace

LabelMatch match_labels(MeshToJudge& mesh, const Against* against, RunReport& report) {
  return LabelMatcher(mesh, against, report).run();
}

}  // namespace stackmesh
