// The fuzzer of the pipeline without libFuzzer, for compilers that have none, and for the speed of an optimised build:
// inputs of a folder, changed at random.
//   fuzz_plain SECONDS FOLDER [SEED] [FOUND]      what is found goes into FOUND (default: found); a crash leaves it
//   there as `last`
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <string>
#include <vector>

#include "default_run.h"
#include "random_stacks.h"

namespace {

using namespace stackmesh::testing_support;
using Bytes = std::vector<std::uint8_t>;

void write(const std::filesystem::path& path, const Bytes& bytes) {
  std::ofstream(path, std::ios::binary)
      .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
}

Bytes changed(const std::vector<Bytes>& corpus, std::mt19937_64& random) {
  Bytes b = corpus[random() % corpus.size()];
  b.resize(7 + 172, 0);
  if (random() % 3 == 0) {  // a part of another one
    const Bytes& other = corpus[random() % corpus.size()];
    const std::size_t from = random() % b.size();
    for (std::size_t i = from; i < std::min({b.size(), other.size(), from + random() % 64}); ++i) b[i] = other[i];
  }
  for (std::uint64_t k = random() % 12 + 1; k > 0; --k) {
    const std::size_t at = random() % 4 == 0 ? random() % 7 : random() % b.size();
    b[at] = static_cast<std::uint8_t>(random() % 3 == 0 ? b[at] ^ (1u << (random() % 8)) : random());
  }
  return b;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3) return std::fprintf(stderr, "usage: fuzz_plain SECONDS FOLDER [SEED] [FOUND]\n"), 2;
  std::vector<Bytes> corpus;
  for (const auto& entry : std::filesystem::directory_iterator(argv[2])) {
    std::ifstream file(entry.path(), std::ios::binary);
    corpus.push_back(Bytes{std::istreambuf_iterator<char>(file), {}});
  }
  if (corpus.empty())
    return std::fprintf(stderr, "fuzz_plain: error: no inputs in %s; name a folder that has some\n", argv[2]), 2;
  const std::uint64_t seed = argc > 3 ? std::strtoull(argv[3], nullptr, 10) : 1;
  const std::filesystem::path found = argc > 4 ? argv[4] : "found";
  std::filesystem::create_directories(found);
  std::mt19937_64 random(seed);
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(std::atol(argv[1]));
  std::size_t runs = 0, findings = 0, others = 0;
  for (; std::chrono::steady_clock::now() < end; ++runs) {
    const Bytes b = changed(corpus, random);
    write(found / "last", b);
    const DefaultRun run = run_at_defaults(volume_of_bytes(b.data(), b.size()));
    if (run.problem.empty()) continue;
    if (run.problem.find("do not match") != std::string::npos) {  // pieces of noise that join or part
      ++others;
      continue;
    }
    const std::filesystem::path name = found / ("stack_" + std::to_string(seed) + "_" + std::to_string(runs));
    write(name, b);
    std::printf("finding %s: %s\n", name.c_str(), run.problem.c_str());
    std::fflush(stdout);
    ++findings;
  }
  std::filesystem::remove(found / "last");
  std::printf("%zu stacks, %zu findings, %zu with other pieces\n", runs, findings, others);
  return findings == 0 ? 0 : 1;
}
