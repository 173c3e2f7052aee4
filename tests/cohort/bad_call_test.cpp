// Every wrong call of batch and collect: one line that says what, where and how to mend it, before anything starts.
#include <stdlib.h>

#include "small_cohort.h"

namespace cohort_test {
namespace {

class BadCall : public CohortTest {
 protected:
  void SetUp() override {
    CohortTest::SetUp();
    write("a.nrrd", box_volume(9, 6));
  }
  void manifest(const std::string& text, int code, const std::vector<std::string>& parts) const {
    write("cases.csv", text);
    fails(code, {"batch", in("cases.csv"), "-o", cohort()}, parts);
  }
  void options(const std::vector<std::string>& words, int code, const std::vector<std::string>& parts) const {
    write("cases.csv", "id,input\na,a.nrrd\n");
    std::vector<std::string> all = {"batch", in("cases.csv"), "-o", cohort()};
    all.insert(all.end(), words.begin(), words.end());
    fails(code, all, parts);
  }
};

TEST_F(BadCall, Manifests) {
  manifest("id,input,edge-lenght\na,a.nrrd,2\n", 3, {"unknown column 'edge-lenght'", "line 1", "edge-length"});
  manifest("id,input,output\na,a.nrrd,x.vtu\n", 3, {"unknown column 'output'"});
  manifest("id,input,id\na,a.nrrd,b\n", 3, {"column 'id' stands twice"});
  manifest("id\na\n", 3, {"no column 'input'"});
  manifest("", 3, {"the table is empty"});
  manifest("id,input\n", 3, {"no case"});
  manifest("id,input\na,a.nrrd\n\na,a.nrrd\n", 3, {"the id 'a' stands twice", "lines 2 and 4"});
  manifest("id,input\na,b.nrrd\n", 3, {"is not there", "b.nrrd", "line 2"});
  manifest("id,input\na,\n", 3, {"case 'a' has no input", "line 2"});
  for (const char* id :
       {"x/y", "..", "a..b", ".a", "-a", "a.failed", "cohort.csv", "cohort_thumbnails", "failed", "\"a,b\""})
    manifest(std::string("id,input\n") + id + ",a.nrrd\n", 3, {"the id '", "line 2", "it names the case's folder"});
  manifest("id,input\n\"a\nb\",a.nrrd\n", 3, {"control characters", "line 2"});
  manifest("id,input\na,a.nrrd,2\n", 3, {"3 cells under 2 columns", "line 2"});
  manifest("id,input\n\"a,a.nrrd\n", 3, {"quote is not closed", "line 2"});
  manifest("id,input,edge-length\na,a.nrrd,wide\n", 3, {"case 'a'", "line 2", "'wide'"});
  manifest("id,input,merge\na,a.nrrd,perhaps\n", 3, {"'perhaps'", "neither yes nor no"});
  fails(3, {"batch", in("none.csv"), "-o", cohort()}, {"the manifest is not there", "none.csv"});
  fails(3, {"batch", "--inputs", in("*.mha"), "-o", cohort()}, {"the pattern names no file"});
  fails(3, {"batch", folder_ + "/in", "-o", cohort()}, {"no label maps in the layout of BIDS derivatives"});
  fails(2, {"batch", "-o", cohort()}, {"there is no manifest"});
}

TEST_F(BadCall, Options) {
  options({"--", "--edge-lenght", "2"}, 2, {"--edge-lenght", "options of mesh"});
  options({"--", "surface", "--edge-length", "wide"}, 2, {"'wide'"});
  options({"--", "-o", "x.vtu"}, 2, {"batch names the files of a case itself", "--format"});
  options({"--", "validate"}, 2, {"'validate' makes no case"});
  options({"--format", "xyz"}, 2, {"does not write 'xyz'"});
  options({"--format", "vtu", "--", "surface"}, 2, {"surface does not write 'vtu'"});
  options({"--only", "b"}, 2, {"no case is called 'b'"});
  options({"--jobs", "0"}, 2, {"--jobs"});
  options({"--timeout", "-1"}, 2, {"--timeout"});
  options({"--max-memory", "much"}, 2, {"--max-memory", "much"});
  options({"--inputs", "*.nrrd"}, 2, {"both name the cases"});
  options({"--frobnicate"}, 2, {"--frobnicate"});
}

TEST_F(BadCall, FoldersOfSomethingElse) {
  write("cases.csv", "id,input\na,a.nrrd\n");
  write("other.csv", "id,input\nb,a.nrrd\n");
  ASSERT_EQ(batch({"--no-page"}).code, 0);
  fails(2, {"batch", in("other.csv"), "-o", cohort()}, {"the cases of another manifest", in("cases.csv")}, {"cohort"});
  write("moved.csv", "id,input\na,a.nrrd\n");  // the same bytes by another name
  EXPECT_EQ(program::stackmesh({"batch", in("moved.csv"), "-o", cohort(), "--no-page"}).code, 0);
  write("folder/text", "something else");
  fails(2, {"batch", in("cases.csv"), "-o", in("folder")}, {"the folder holds other files"}, {"cohort"});
  fails(5, {"batch", in("cases.csv"), "-o", in("a.nrrd")}, {"the output is a file"}, {"cohort"});
  fails(3, {"collect", in("folder")}, {"holds no cohort"}, {"cohort"});
  fails(3, {"batch", "--status", "-o", in("folder")}, {"holds no cohort"}, {"cohort"});
}

TEST_F(BadCall, SlurmIsNotThere) {
  write("cases.csv", "id,input\na,a.nrrd\n");
  program::Around nowhere;
  nowhere.in_child = [] { return ::setenv("PATH", "/nowhere", 1) == 0; };
  fails(2, {"batch", in("cases.csv"), "-o", cohort(), "--slurm", "--partition=x"}, {"Slurm is not here", "sbatch"}, {},
        nowhere);
}

}  // namespace
}  // namespace cohort_test
