// For threads that write beside a loop, and the files they write.
#pragma once

#include <functional>
#include <string>
#include <thread>

namespace spikeloop {

/// A thread that no signal interrupts: signals go to the threads that expect them.
std::thread background_thread(std::function<void()> work);

/// Creates a file or empties it. Libraries that write files seldom tell the system's reason, so it
/// is asked for first. @throws FileError.
void make_empty_file(const std::string& path);

}  // namespace spikeloop
