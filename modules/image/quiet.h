#pragma once
#include <iostream>
#include <mutex>
#include <sstream>

namespace stackmesh {

/// GDCM (through ITK) writes to std::cerr, which the library must not; while one of these lives it does not. It
/// also lets one reader run at a time, since the stream and some of those readers are shared.
class Quiet {
 public:
  Quiet() : lock_(mutex()), saved_(std::cerr.rdbuf(sink_.rdbuf())) {}
  ~Quiet() { std::cerr.rdbuf(saved_); }
  Quiet(const Quiet&) = delete;
  Quiet& operator=(const Quiet&) = delete;

 private:
  static std::mutex& mutex() {
    static std::mutex m;
    return m;
  }
  std::lock_guard<std::mutex> lock_;
  std::ostringstream sink_;
  std::streambuf* saved_;
};

}  // namespace stackmesh
