// Whole files in and out of memory.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace salbench {

// All bytes of a regular file. Throws InputError for what is missing, unreadable, or no file.
std::string read_file(const std::filesystem::path& path);

// Replaces the file in one step: whoever reads it sees the old text or the new one, never a part, even after
// a crash. The folder must exist. Throws StorageError with the system's reason.
void write_text_file(const std::filesystem::path& path, std::string_view text);

// Removes what write_text_file left in a folder where a process was killed in the middle of it. Not to be
// called while another process writes there.
void remove_unfinished(const std::filesystem::path& folder);

}  // namespace salbench
