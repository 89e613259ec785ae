#include "files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <optional>
#include <sstream>
#include <utility>

namespace spikeloop::view {
namespace {

// All that the page needs of the run folder.
constexpr std::string_view kRunFiles[] = {"resolved.json", "world.json", "trajectory.csv",
                                          "episodes.csv", "summary.json"};
constexpr std::string_view kRun = "/run/";

/// Of a folder without subfolders: no path leads out of it.
bool is_plain_name(std::string_view name) {
  return !name.empty() && name.front() != '.' && std::ranges::all_of(name, [](unsigned char c) {
    return std::isalnum(c) != 0 || c == '.' || c == '_' || c == '-';
  });
}

std::string type_of(std::string_view name) {
  static constexpr std::pair<std::string_view, const char*> kTypes[] = {
      {".html", "text/html; charset=utf-8"},
      {".js", "text/javascript; charset=utf-8"},
      {".css", "text/css; charset=utf-8"},
      {".json", "application/json"},
      {".svg", "image/svg+xml"},
      {".csv", "text/csv; charset=utf-8"}};
  for (const auto& [extension, type] : kTypes) {
    if (name.ends_with(extension)) {
      return type;
    }
  }
  return "application/octet-stream";
}

/// Where to begin; nothing: not as "bytes=N-".
std::optional<std::uintmax_t> begin_of(std::string_view range) {
  constexpr std::string_view kBytes = "bytes=";
  std::uintmax_t begin = 0;
  if (!range.starts_with(kBytes)) {
    return std::nullopt;
  }
  const auto [end, error] =
      std::from_chars(range.data() + kBytes.size(), range.data() + range.size(), begin);
  return error == std::errc() && std::string_view(end, range.data() + range.size()) == "-"
             ? std::optional(begin)
             : std::nullopt;
}

Answer read(const std::string& path, std::string_view range) {
  std::error_code error;
  auto file = std::make_unique<std::ifstream>(path, std::ios::binary);
  if (!std::filesystem::is_regular_file(path, error) || !*file) {
    return error_answer(404);
  }
  const std::uintmax_t size = std::filesystem::file_size(path, error);
  const auto begin = size == 0 ? std::nullopt : begin_of(range);
  if (begin && *begin >= size) {
    Answer answer = error_answer(416);
    answer.range = fmt::format("bytes */{}", size);
    return answer;
  }
  file->seekg(static_cast<std::streamoff>(begin.value_or(0)));
  return {begin ? 206U : 200U, type_of(path),
          begin ? fmt::format("bytes {}-{}/{}", *begin, size - 1, size) : "", std::move(file),
          size - begin.value_or(0)};
}

}  // namespace

Answer error_answer(unsigned status) {
  auto text = std::make_unique<std::istringstream>(fmt::format("{}\n", status));
  const std::size_t size = text->view().size();
  return {status, "text/plain", "", std::move(text), size};
}

Answer answer(std::string_view path, std::string_view range, const std::string& page,
              const std::string& run) {
  if (path.starts_with(kRun)) {
    const std::string_view name = path.substr(kRun.size());
    const bool known = std::ranges::find(kRunFiles, name) != std::end(kRunFiles);
    return known && !run.empty() ? read(run + "/" + std::string(name), range) : error_answer(404);
  }
  const std::string_view name = path == "/" ? "index.html" : path.substr(1);
  return is_plain_name(name) ? read(page + "/" + std::string(name), range) : error_answer(404);
}

}  // namespace spikeloop::view
