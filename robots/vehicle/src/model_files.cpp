#include "model_files.hpp"

#include <filesystem>
#include <set>

#include "spikeloop/core/error.hpp"
#include "spikeloop/core/file.hpp"
#include "spikeloop/core/files_read.hpp"
#include "spikeloop/vehicle/simulation.hpp"

namespace spikeloop::vehicle {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kLargestText = 10'000'000;  // bytes
constexpr std::size_t kMostFolders = 10;

/// Follows the names of files from a model to all files that it is made of.
class Collector {
 public:
  explicit Collector(const std::string& model) : model_(model) { add(model_); }

  std::vector<ModelText> texts;

 private:
  void add(const fs::path& file) {
    std::error_code error;
    if (!fs::is_regular_file(file, error) || !seen_.insert(file).second) {
      return;
    }
    FilesRead::note(file.string());
    if (file != model_ && file.extension() != ".xml") {
      return;
    }
    std::string text;
    try {
      text = read_file(file.string(), "model", kLargestText);
    } catch (const Error&) {
      return;  // MuJoCo reports it
    }
    std::vector<fs::path> named;
    for (const Attribute& attribute : parse_attributes(text)) {
      const bool is_folder = attribute.name == "meshdir" || attribute.name == "texturedir" ||
                             attribute.name == "assetdir";
      if (is_folder && folders_.size() < kMostFolders) {
        folders_.emplace_back(attribute.value);
      } else if (attribute.name == "file") {
        named.emplace_back(attribute.value);
      }
    }
    texts.push_back({file.string(), std::move(text)});
    for (const fs::path& name : named) {
      for (const fs::path& folder : std::vector(folders_)) {
        add((model_.parent_path() / folder / name).lexically_normal());
      }
      add((file.parent_path() / name).lexically_normal());
    }
  }

  fs::path model_;
  std::vector<fs::path> folders_{""};
  std::set<fs::path> seen_;
};

}  // namespace

std::vector<ModelText> read_model_files(const std::string& path) {
  std::error_code error;
  const fs::path shipped = fs::path(find_world("arena")).parent_path();
  if (fs::equivalent(fs::path(path).parent_path(), shipped, error)) {
    return {};
  }
  return Collector(path).texts;
}

}  // namespace spikeloop::vehicle
