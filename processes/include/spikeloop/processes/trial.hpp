// Libraries that may crash or hang on a file that somebody else wrote.
#pragma once

#include <functional>
#include <string>
#include <string_view>

namespace spikeloop {

/// Does `work`, which reads the file, in a forked copy of this process: a crash or a hang of
/// `library` there is an error here. It may take 4 s of processor time, a second more for each
/// 20 MB of the file, 4 GB of memory, and three times the size of the file. What it throws itself
/// is not told: the caller does the same work after it, in this process. Each file is tried once,
/// until it changes.
/// @throws FileError: `library` crashed, hung, or took too long; ConfigurationError: too much
/// memory.
void try_in_a_copy(const std::string& path, std::string_view library,
                   const std::function<void()>& work);

}  // namespace spikeloop
