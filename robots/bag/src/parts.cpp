#include "parts.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <map>
#include <optional>
#include <regex>
#include <set>

#include "spikeloop/core/code.hpp"
#include "spikeloop/core/error.hpp"
#include "spikeloop/core/file.hpp"

namespace spikeloop::bag {
namespace {

namespace fs = std::filesystem;

constexpr const char* kMetadata = "metadata.yaml";
constexpr const char* kPacked = ".zstd";

/// "drive_3.mcap.zstd" is part 3 of "drive".
struct Name {
  std::string recording;
  std::uint64_t part = 0;
  std::string ending;
  bool has_number = false;
};

/// nullopt: not the name of a recording.
std::optional<Name> parse_name(const std::string& file) {
  static const std::regex pattern(R"((.*?)(?:_(\d{1,18}))?(\.(?:mcap|db3|bag)(?:\.zstd?)?))");
  // `rosbag record --split` puts the time at which a part begins into its name.
  static const std::regex date(R"(\d{4}(?:-\d\d){5}$)");
  std::smatch found;
  if (!std::regex_match(file, found, pattern)) {
    return std::nullopt;
  }
  Name name{found[1], found[2].matched ? std::stoull(found[2]) : 0, found[3], found[2].matched};
  if (name.ending.ends_with(".zst")) {
    name.ending += 'd';
  }
  if (found[2].matched) {
    name.recording = std::regex_replace(name.recording, date, "");
  }
  return name;
}

struct Metadata {
  std::vector<std::string> files;
  std::string packed_messages;  ///< format; empty if messages are not compressed
};

[[noreturn]] void refuse_metadata(const std::string& path, std::string_view why) {
  throw FileError(with_code(Code::no_access,
                            "'{}' is damaged: {}; remove it, and the parts are found by their "
                            "names",
                            path, why));
}

/// nullopt: the folder has none.
std::optional<Metadata> read_metadata(const fs::path& folder) {
  const std::string path = (folder / kMetadata).string();
  if (!fs::exists(path)) {
    return std::nullopt;
  }
  constexpr std::uint64_t kLimit = 10'000'000;
  const std::string text = read_file(path, kMetadata, kLimit);
  try {
    const YAML::Node whole = YAML::Load(text)["rosbag2_bagfile_information"];
    Metadata metadata;
    for (const YAML::Node& file : whole["relative_file_paths"]) {
      metadata.files.push_back(file.as<std::string>());
    }
    if (const YAML::Node mode = whole["compression_mode"]) {
      std::string name = mode.as<std::string>();
      std::ranges::transform(name, name.begin(), [](unsigned char c) { return std::tolower(c); });
      metadata.packed_messages =
          name == "message" ? whole["compression_format"].as<std::string>() : "";
    }
    return metadata;
  } catch (const YAML::Exception& error) {
    refuse_metadata(path, error.msg);
  }
}

/// Where a part is that metadata.yaml lists. Until Foxy its path began with the folder. A part may
/// have been unpacked, or compressed, since.
std::optional<fs::path> find_listed(const fs::path& folder, const std::string& listed) {
  for (const fs::path& base : {folder / listed, folder / fs::path(listed).filename()}) {
    fs::path other = base;
    other =
        base.extension() == kPacked ? other.replace_extension() : fs::path(base.string() + kPacked);
    for (const fs::path& file : {base, other}) {
      if (fs::is_regular_file(file)) {
        return file;
      }
    }
  }
  return std::nullopt;
}

/// Names of the recordings in a folder.
std::vector<std::string> recordings_in(const fs::path& folder) {
  std::vector<std::string> names;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    if (parse_name(entry.path().filename().string())) {
      names.push_back(entry.path().filename().string());
    }
  }
  std::ranges::sort(names);
  return names;
}

Parts listed_parts(const fs::path& folder, const Metadata& metadata) {
  Parts parts;
  if (!metadata.packed_messages.empty() && metadata.packed_messages != "zstd") {
    throw FileError(with_code(Code::no_access,
                              "'{}': the messages are compressed by '{}', and only zstd is "
                              "supported; write  ros2 bag convert  without compression",
                              folder.string(), metadata.packed_messages));
  }
  std::set<std::string> names;
  for (const std::string& listed : metadata.files) {
    const auto file = find_listed(folder, listed);
    if (!file) {
      throw FileError(with_code(Code::no_access,
                                "'{}' lists the part {}, which is missing; copy it to the folder, "
                                "or remove it from the list",
                                (folder / kMetadata).string(), listed));
    }
    parts.files.push_back(file->string());
    names.insert(file->filename().string());
    names.insert(fs::path(listed).filename().string());
  }
  for (const std::string& name : recordings_in(folder)) {
    if (!names.contains(name) && !names.contains(name + kPacked) &&
        !names.contains(fs::path(name).replace_extension().string())) {
      parts.warnings.push_back(
          fmt::format("'{}' is left out, because {} does not list it; add it there, or remove {}",
                      (folder / name).string(), kMetadata, kMetadata));
    }
  }
  return parts;
}

[[noreturn]] void refuse_several(const fs::path& folder, const std::set<std::string>& recordings) {
  throw FileError(with_code(Code::no_access,
                            "'{}' has several recordings: {}; write the path of one of them",
                            folder.string(), fmt::join(recordings, ", ")));
}

/// Parts by their names.
Parts named_parts(const fs::path& folder) {
  // If a part exists in several formats, the first of these is read.
  constexpr std::string_view kOrder[] = {".mcap",      ".db3",      ".bag",
                                         ".mcap.zstd", ".db3.zstd", ".bag.zstd"};
  std::map<std::pair<std::uint64_t, std::ptrdiff_t>, std::string> found;
  std::set<std::string> recordings;
  std::set<std::string> files;
  for (const std::string& file : recordings_in(folder)) {
    const Name name = *parse_name(file);
    recordings.insert(name.recording);
    files.insert(file);
    found[{name.part, std::ranges::find(kOrder, name.ending) - kOrder}] = file;
  }
  if (recordings.size() > 1 || found.size() < files.size()) {
    refuse_several(folder, files);
  }
  Parts parts;
  std::optional<std::uint64_t> before;
  for (const auto& [key, file] : found) {
    if (before == key.first) {
      parts.warnings.push_back(fmt::format("'{}' is left out, because '{}' is the same part",
                                           (folder / file).string(), parts.files.back()));
    } else {
      parts.files.push_back((folder / file).string());
      if (before && key.first > *before + 1) {
        parts.warnings.push_back(fmt::format("'{}': part {} is missing before '{}'",
                                             folder.string(), *before + 1, file));
      }
    }
    before = key.first;
  }
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    if (entry.path().string().ends_with(".bag.active")) {
      parts.warnings.push_back(fmt::format(
          "'{0}' is incomplete and is skipped; run  rosbag reindex {0}  and remove  .active  "
          "from its name",
          entry.path().string()));
    }
  }
  return parts;
}

Parts parts_of_folder(const fs::path& folder) {
  const auto metadata = read_metadata(folder);
  Parts parts =
      metadata && !metadata->files.empty() ? listed_parts(folder, *metadata) : named_parts(folder);
  if (parts.files.empty()) {
    throw FileError(with_code(
        Code::no_access,
        "'{}' is a folder without a recording; write the path of a .mcap, .db3 or .bag file, or of "
        "a folder of 'ros2 bag record'",
        folder.string()));
  }
  return parts;
}

/// Number of parts of a file's recording according to metadata.yaml. 0 if it does not list the
/// file.
std::size_t count_listed(const fs::path& file, const fs::path& folder) {
  try {
    const auto metadata = read_metadata(folder);
    for (const std::string& listed : metadata ? metadata->files : std::vector<std::string>{}) {
      if (fs::path(listed).filename() == file.filename()) {
        return metadata->files.size();
      }
    }
  } catch (const Error&) {  // the file itself may still be good
  }
  return 0;
}

/// Number of the parts NAME_0, NAME_1, ... of a file's recording. 0 if the file is not one of them.
/// Names that begin at NAME_1 are not parts: users often number recordings from 1.
std::size_t count_named(const fs::path& file, const fs::path& folder) {
  const auto name = parse_name(file.filename().string());
  if (!name || !name->has_number) {
    return 0;
  }
  std::set<std::uint64_t> parts;
  for (const std::string& other_file : recordings_in(folder)) {
    const Name other = *parse_name(other_file);
    if (other.has_number && other.recording == name->recording) {
      parts.insert(other.part);
    }
  }
  return parts.contains(0) && parts.contains(1) ? parts.size() : 0;
}

bool is_one_recording(const fs::path& folder) {
  try {
    named_parts(folder);
    return true;
  } catch (const Error&) {
    return false;
  }
}

/// Warns if a file is one of several parts.
std::vector<std::string> warn_of_others(const fs::path& file) try {
  const fs::path folder = file.has_parent_path() ? file.parent_path() : fs::path(".");
  const std::size_t listed = count_listed(file, folder);
  const std::size_t count = listed > 0 ? listed : count_named(file, folder);
  if (count < 2) {
    return {};
  }
  const std::string remedy = listed > 0 || is_one_recording(folder)
                                 ? fmt::format("write the path {}", folder.string())
                                 : "move them to a folder of their own and write its path";
  return {fmt::format("'{}' is one of {} parts of a recording; {} to read all", file.string(),
                      count, remedy)};
} catch (const fs::filesystem_error&) {  // the folder cannot be listed, but the file may be read
  return {};
}

}  // namespace

Parts find_parts(const std::string& path) try {
  const fs::path given(path);
  if (fs::is_directory(given)) {
    return parts_of_folder(given);
  }
  if (given.filename() == kMetadata) {
    return parts_of_folder(given.has_parent_path() ? given.parent_path() : fs::path("."));
  }
  return {{path}, warn_of_others(given)};
} catch (const fs::filesystem_error& error) {
  throw FileError("read", path, error.code().value());
}

}  // namespace spikeloop::bag
