// Background threads that write files while the loop runs.
#pragma once

#include <functional>
#include <thread>

namespace spikeloop {

/// A thread that no signal interrupts: signals go to the threads that expect them.
std::thread background_thread(std::function<void()> work);

}  // namespace spikeloop
