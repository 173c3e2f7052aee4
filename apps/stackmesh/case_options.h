#pragma once
#include <string>
#include <vector>

#include "cohort/cohort_case.h"

namespace stackmesh::app {

/// The command that makes each case ("mesh", "surface" or "fem"), with the options that a case may have.
CaseCommand case_command(const std::string& name, const std::vector<std::string>& formats);

/// The words behind "--", by name, as the command understands them. @throws Error(usage)
std::vector<OptionValue> read_case_options(const std::string& command, const std::vector<std::string>& words);

}  // namespace stackmesh::app
