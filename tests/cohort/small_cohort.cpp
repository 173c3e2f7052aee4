#include "small_cohort.h"

#include <algorithm>
#include <filesystem>
#include <sstream>

namespace cohort_test {

std::string box_volume(int width, int height, bool second, double spacing_mm) {
  std::ostringstream head;
  const std::string s = std::to_string(spacing_mm);
  head << "NRRD0004\ntype: uint8\ndimension: 3\nspace: left-posterior-superior\nsizes: " << width << " " << width << " "
       << height << "\nspace directions: (" << s << ",0,0) (0," << s << ",0) (0,0," << s
       << ")\nspace origin: (0,0,0)\nencoding: raw\n\n";
  std::string bytes = head.str();
  for (int z = 0; z < height; ++z)
    for (int y = 0; y < width; ++y)
      for (int x = 0; x < width; ++x) {
        const bool inside = x >= 2 && x < width - 2 && y >= 2 && y < width - 2 && z >= 1 && z < height - 1;
        bytes.push_back(static_cast<char>(!inside ? 0 : second && z >= height / 2 ? 2 : 1));
      }
  return bytes;
}

std::string CohortTest::four_cases() const {
  write("a.nrrd", box_volume(9, 6));
  write("b.nrrd", box_volume(10, 6, true));
  write("c.nrrd", box_volume(9, 7));
  write("bad.nrrd", "NRRD0004\nthis is none\n");
  return write("cases.csv", "id,input\na,a.nrrd\nb,b.nrrd\nbad,bad.nrrd\nc,c.nrrd\n");
}

Ended CohortTest::batch(const std::vector<std::string>& words) const {
  std::vector<std::string> all = {"batch", in("cases.csv"), "-o", cohort()};
  all.insert(all.end(), words.begin(), words.end());
  return program::stackmesh(all);
}

Json CohortTest::json(const std::string& name) const {
  const Json j = Json::parse(program::read_file(in_cohort(name)), nullptr, false);
  EXPECT_FALSE(j.is_discarded()) << name << " is no JSON";
  return j;
}

int CohortTest::times(const std::string& event, const std::string& id) const {
  int n = 0;
  for (const std::string& line : program::lines_of(program::read_file(in_cohort(".cohort/journal.tsv"))))
    n += line.find("\t" + event + "\t" + id + "\t") != std::string::npos;
  return n;
}

std::vector<std::string> CohortTest::names() const {
  std::vector<std::string> found;
  for (const auto& entry : std::filesystem::directory_iterator(cohort()))
    if (entry.path().filename() != ".cohort") found.push_back(entry.path().filename().string());
  std::sort(found.begin(), found.end());
  return found;
}

}  // namespace cohort_test
