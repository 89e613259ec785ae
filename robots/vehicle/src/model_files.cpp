#include "model_files.hpp"

#include <filesystem>
#include <regex>
#include <set>

#include "spikeloop/core/error.hpp"
#include "spikeloop/core/file.hpp"
#include "spikeloop/core/files_read.hpp"
#include "spikeloop/vehicle/simulation.hpp"

namespace spikeloop::vehicle {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kLargestText = 10'000'000;  // bytes

std::vector<std::string> values_of(const std::string& text, const char* attributes) {
  const std::regex pattern(std::string("\\b(?:") + attributes + ")\\s*=\\s*[\"']([^\"']+)[\"']");
  std::vector<std::string> values;
  for (std::sregex_iterator match(text.begin(), text.end(), pattern), end; match != end; ++match) {
    values.push_back((*match)[1]);
  }
  return values;
}

void note(const fs::path& file, const fs::path& model, std::vector<std::string>& folders,
          std::set<fs::path>& seen) {
  std::error_code error;
  if (!fs::is_regular_file(file, error) || !seen.insert(file).second) {
    return;
  }
  FilesRead::note(file.string());
  if (file.extension() != ".xml") {
    return;
  }
  std::string text;
  try {
    text = read_file(file.string(), "model", kLargestText);
  } catch (const Error&) {
    return;  // MuJoCo has read the model without it
  }
  for (const std::string& folder : values_of(text, "meshdir|texturedir|assetdir")) {
    folders.push_back(folder);
  }
  for (const std::string& name : values_of(text, "file")) {
    for (const std::string& folder : std::vector(folders)) {
      note((model.parent_path() / folder / name).lexically_normal(), model, folders, seen);
    }
    note((file.parent_path() / name).lexically_normal(), model, folders, seen);
  }
}

}  // namespace

void note_model_files(const std::string& path) {
  std::error_code error;
  const fs::path shipped = fs::path(find_world("arena")).parent_path();
  if (fs::equivalent(fs::path(path).parent_path(), shipped, error)) {
    return;
  }
  std::vector<std::string> folders{""};
  std::set<fs::path> seen;
  note(fs::path(path), fs::path(path), folders, seen);
}

}  // namespace spikeloop::vehicle
