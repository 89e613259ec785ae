// Weight tables: a short form, a JSON file, or a .npy file of NumPy.
//
//   uniform            every weight is 1 / inputs         uniform:0.01      every weight is 0.01
//   one_to_one         output i reads input i             one_to_one:2      ... with weight 2
//   blocks             output i is the mean of the i-th block of neighbouring inputs; blocks:2
//   twice it even               a table without size and numbers: what the node makes of its
//   widths, where
//                      it knows such a rule (population_vector)
//   readout.json       [[0.1, 0.2], [0.3, 0.4]]: one row an output, one column an input
//                      {"rows": 2, "columns": 1000, "entries": [[0, 17, 0.5], [1, 999, -1]]}:
//                      [row, column, weight], both counting from 0, what is not named is 0
//   readout.npy        numpy.save("readout.npy", weights): numbers [output, input], or a single
//   row;
//                      see npy_file.hpp. Known by its first bytes, whatever the name
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include "spikeloop/core/parameters.hpp"
#include "spikeloop/core/weights.hpp"

namespace spikeloop {

struct WeightOptions {
  /// Relative paths start here, or else in the current directory.
  std::filesystem::path base_directory{};
  /// False reads as the older programs did, with a warning in the log: a missing file or one that
  /// is neither JSON nor a .npy file of finite numbers gives 1 / inputs; missing weights are 0,
  /// surplus ones are left out.
  bool strict = true;
  /// Widths of the output and input port, 0 when unknown. Not strict: the table is fitted to them.
  std::uint32_t rows = 0;
  std::uint32_t columns = 0;
  std::uint64_t maximum_bytes = 1'000'000'000;
  std::string what = "weight file";  ///< the file's name in messages
  bool short_forms = true;           ///< "uniform" and "one_to_one" are no files
  Location named_in{};               ///< where the file is named, for warnings
};

/// More rows or columns than any port can have.
inline constexpr std::uint32_t kMaximumChannels = 16'777'216;

/// Parses the bytes of a weight file; `file` names it in messages, and one that ends in .npy must
/// be such a file.
/// @throws ConfigurationError with file, row, column, value and remedy; rows and columns count from
/// 0.
WeightTable parse_weights(std::string_view text, const std::string& file,
                          const WeightOptions& options = {});

/// A short form, or the file of that name.
/// @throws ConfigurationError as `parse_weights`, and when there is no such file; FileError when it
/// cannot be read.
WeightTable read_weights(const std::string& written, const WeightOptions& options = {});

/// Writes a dense or sparse table so that read_weights() gives it back: a path that ends in .json
/// gets the entries, with their zeros; any other one an array of NumPy.
/// @throws FileError when it cannot be written.
void write_weights(const std::filesystem::path& path, const WeightTable& table);

/// `read_weights` for `resolve`, which adds key and place to the messages.
WeightLoader weight_loader(WeightOptions options);

}  // namespace spikeloop
