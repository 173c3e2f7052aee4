#include "base/cancel.h"

#include "base/error.h"

namespace stackmesh {
namespace {
thread_local const Monitor* current = nullptr;
}  // namespace

CancelScope::CancelScope(const Monitor* monitor) : outer_(current) {
  current = monitor;
}
CancelScope::~CancelScope() {
  current = outer_;
}

const Monitor* cancelling_monitor() {
  return current;
}

void stop_if_cancelled() {
  if (current != nullptr && current->cancelled()) throw Error(ErrorKind::cancelled, "the run was cancelled", "", "");
}

}  // namespace stackmesh
