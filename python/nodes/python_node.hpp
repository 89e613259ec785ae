// A node made of a Python class or function: the functions of spikeloop_node_class.
#pragma once

#include <cstdint>

#include "spikeloop/core/plugin.h"

namespace spikeloop::python {

void* create_node(const spikeloop_setup* setup, char* error, std::uint64_t error_size);
int step_node(void* node, const spikeloop_step* step, char* error, std::uint64_t error_size);
std::uint32_t count_of_node(void* node, spikeloop_counter* counters, std::uint32_t capacity,
                            char* error, std::uint64_t error_size);
void destroy_node(void* node);

}  // namespace spikeloop::python
