// Files that a recording consists of.
#pragma once

#include <string>
#include <vector>

namespace spikeloop::bag {

struct Parts {
  std::vector<std::string> files;  ///< in the order of time
  std::vector<std::string> warnings;
};

/// The files of a folder, or of the folder of a metadata.yaml; any other path by itself.
///
/// A folder of `ros2 bag record` has a metadata.yaml that lists them. A recorder that was killed
/// leaves none: then they are the files NAME_0, NAME_1, ... of one NAME.
/// @throws FileError: no recording, several of them, a part is missing
Parts find_parts(const std::string& path);

}  // namespace spikeloop::bag
