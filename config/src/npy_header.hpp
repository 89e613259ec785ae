// The header of a .npy file: a dictionary as Python writes it.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace spikeloop::npy {

struct Header {
  std::string type;  ///< "<f8"; empty: named fields
  bool by_columns = false;
  std::vector<std::uint64_t> shape;
};

/// "{'descr': '<f8', 'fortran_order': False, 'shape': (2, 3), }", keys in any order; nothing when
/// it is not of this form.
std::optional<Header> parse_header(std::string_view text);

}  // namespace spikeloop::npy
