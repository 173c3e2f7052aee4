#pragma once
#include <cstdint>
#include <string>

namespace stackmesh {

/// The bytes that this process may take: what set_memory_limit() said, else the smallest of the machine's memory, its
/// control group's bound and the process's own (ulimit).
std::uint64_t memory_limit();

/// Bounds what this process and the processes that it starts may take, each: the kernel then refuses more, which is
/// std::bad_alloc. 0: what machine and control group have. Call it once, before threads are started.
void set_memory_limit(std::uint64_t bytes);

/// The bytes of private data that this process holds now.
std::uint64_t memory_in_use();

/// @throws Error(no_result) with both figures where `bytes` more would pass the bound: "WHAT need 3.2 GB ...".
void require_memory(std::uint64_t bytes, const std::string& what, const std::string& where, const std::string& mend);

/// "512MB", "4G", "1.5 GB" or bytes. @throws Error(usage)
std::uint64_t parse_memory(const std::string& text, const std::string& option);

/// "3.2 GB"
std::string memory_text(std::uint64_t bytes);

}  // namespace stackmesh
