#pragma once
#include <string>

namespace stackmesh {

/// A file of ours that is installed for programs and not for users: beside the running program or the library that
/// holds this code, in their ../libexec/stackmesh, or where it was installed. "": it is nowhere.
/// @param name of the file, without a folder
/// @param mode what access() asks: X_OK for a program, R_OK for a shared object
std::string find_installed(const std::string& name, int mode);

/// A function of a part, which is a shared object that is loaded when it is first needed, because its libraries are
/// many and take long to load. The environment's STACKMESH_PARTS names another folder of parts. A part stays until the
/// program ends.
/// @param part the name of its file, without ".so"
/// @param function its name as the part exports it (extern "C"); the caller knows its type
/// @param purpose what it is needed for, for the message
/// @throws Error(no_result) where the part is absent, cannot be loaded, or belongs to another version
void* function_of_part(const std::string& part, const char* function, const std::string& purpose);

}  // namespace stackmesh
