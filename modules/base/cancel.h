#pragma once
#include "base/monitor.h"

namespace stackmesh {

/// While it lives, stop_if_cancelled() on this thread, and on the threads that parallel_for() takes from it, asks
/// `monitor`. Scopes nest; null: nothing is asked.
class CancelScope {
 public:
  /// @param monitor outlives the scope
  explicit CancelScope(const Monitor* monitor);
  ~CancelScope();
  CancelScope(const CancelScope&) = delete;
  CancelScope& operator=(const CancelScope&) = delete;

 private:
  const Monitor* outer_;
};

/// The monitor that this thread asks; null: none.
const Monitor* cancelling_monitor();

/// Called in every long loop. @throws Error(cancelled) where the monitor of the run says so.
void stop_if_cancelled();

}  // namespace stackmesh
