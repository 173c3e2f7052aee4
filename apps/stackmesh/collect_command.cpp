#include <cstdio>
#include <memory>

#include "base/error.h"
#include "base/text.h"
#include "cohort/collect.h"
#include "commands.h"

namespace stackmesh::app {

void add_collect_command(CLI::App& program) {
  struct Arguments {
    std::string folder;
    bool no_pictures = false, quiet = false;
    int threads = 0;
  };
  CLI::App* command = program.add_subcommand("collect", "The page and tables of a cohort: failures and outliers first");
  auto a = std::make_shared<Arguments>();
  command->add_option("FOLDER", a->folder, "folder that batch wrote")->required();
  command->add_flag("--no-pictures", a->no_pictures, "leave out the pictures of the meshes");
  command->add_option("--threads", a->threads, "threads (default: all)")->check(CLI::Range(1, 1024));
  command->add_flag("--quiet", a->quiet, "only errors");
  command->callback([a] {
    const Cohort cohort = collect(CohortFolder(a->folder), {!a->no_pictures, a->threads});
    const std::size_t done = cohort.count(CohortRow::State::done), all = cohort.rows.size();
    if (!a->quiet) {
      std::printf(
          "%zu cases: %zu done, %zu failed, %zu made with other options, %zu not run; of those done %zu outside their "
          "limits, %zu outliers among the others\n",
          all, done, cohort.count(CohortRow::State::failed), cohort.count(CohortRow::State::changed),
          cohort.count(CohortRow::State::missing), cohort.outside(), cohort.outliers());
      for (const char* name : {"cohort.html", "cohort.csv", "cohort.json"})
        std::printf("written  %s\n", printable(a->folder + "/" + name).c_str());
      std::fflush(stdout);
    }
    if (cohort.exit_code() == static_cast<int>(ErrorKind::no_result))
      throw Error(ErrorKind::no_result,
                  std::to_string(all - done) + " of " + std::to_string(all) + " cases have no result",
                  a->folder + "/cohort.html", "read there why, and run the batch again");
    if (cohort.exit_code() != 0)
      throw Error(ErrorKind::outside_limits,
                  std::to_string(cohort.outside()) + " of " + std::to_string(all) + " cases are outside their limits",
                  a->folder + "/cohort.html", "look at the first ones there");
  });
}

}  // namespace stackmesh::app
