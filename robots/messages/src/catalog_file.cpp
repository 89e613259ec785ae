// Definitions from a user's own files.
#include <fmt/format.h>

#include <filesystem>
#include <mutex>
#include <utility>

#include "spikeloop/core/code.hpp"
#include "spikeloop/core/error.hpp"
#include "spikeloop/core/file.hpp"
#include "spikeloop/messages/catalog.hpp"

namespace spikeloop::messages {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kEnding = ".msg";

std::string read_text(const std::string& path) {
  constexpr std::uint64_t kMostBytes = 1'000'000;
  try {
    return read_file(path, ".msg file", kMostBytes);
  } catch (const FileError&) {
    throw ConfigurationError(
        with_code(Code::unknown_message,
                  "message definition '{}' cannot be read; write the path of a .msg file", path));
  }
}

std::string name_of_file(const fs::path& file) {
  const fs::path folder = file.parent_path();
  if (folder.filename() != "msg" || folder.parent_path().filename().empty()) {
    throw ConfigurationError(with_code(
        Code::unknown_message,
        "message definition '{}' is in no package; put it where ROS has it, PACKAGE/msg/{}",
        file.string(), file.filename().string()));
  }
  return fmt::format("{}/{}", folder.parent_path().filename().string(), file.stem().string());
}

/// PACKAGE/msg/TYPE.msg, where `file` is OTHER/msg/SOMETHING.msg.
fs::path file_beside(const fs::path& file, const std::string& type) {
  const auto slash = type.find('/');
  return file.parent_path().parent_path().parent_path() / type.substr(0, slash) / "msg" /
         (type.substr(slash + 1) + std::string(kEnding));
}

}  // namespace

std::string Catalog::add_file(const std::string& path) {
  constexpr std::size_t kMostFiles = 500;
  if (files_.size() > 2 * kMostFiles) {  // each by two names
    throw ConfigurationError(
        with_code(Code::unknown_message,
                  "message definition '{}' is the {}th that is needed; write a simpler message",
                  path, kMostFiles + 1));
  }
  const fs::path file = fs::absolute(path).lexically_normal();
  const std::string name = name_of_file(file);
  const Definition& definition =
      definitions_.insert_or_assign(name, parse_definition(name, read_text(path), dialect_, path))
          .first->second;
  files_.insert_or_assign(path, name);
  files_.insert_or_assign(file.string(), name);
  add_parts_beside(definition, file.string());
  return name;
}

void Catalog::add_parts_beside(const Definition& whole, const std::string& path) {
  const std::string package = whole.name.substr(0, whole.name.find('/') + 1);
  for (const FieldDefinition& field : whole.fields) {
    const fs::path beside = file_beside(path, field.type);
    const bool read = field.primitive != Primitive::message || files_.contains(beside.string());
    const bool ours = field.type.starts_with(package) && fs::exists(beside);
    if (read || (contains(field.type) && !ours)) {
      continue;
    }
    if (!fs::exists(beside)) {
      throw ConfigurationError(with_code(
          Code::unknown_message,
          "message type '{}' needs '{}' for its field '{}', which is neither known nor a file {}; "
          "put its definition there",
          whole.name, field.type, field.name, beside.string()));
    }
    add_file(beside.string());
  }
}

const Catalog& Catalog::for_type(Dialect dialect, std::string_view type) {
  static std::mutex mutex;
  static std::map<std::pair<Dialect, std::string>, Catalog> catalogs;
  const std::lock_guard lock(mutex);
  if (!type.ends_with(kEnding)) {
    for (const auto& [key, catalog] : catalogs) {
      if (key.first == dialect && !builtin(dialect).contains(type) && catalog.contains(type)) {
        return catalog;
      }
    }
    return builtin(dialect);
  }
  const std::pair key(dialect, std::string(type));
  if (const auto found = catalogs.find(key); found != catalogs.end()) {
    return found->second;
  }
  Catalog catalog = builtin(dialect);
  catalog.add_file(key.second);
  return catalogs.emplace(key, std::move(catalog)).first->second;
}

}  // namespace spikeloop::messages
