#include "files.hpp"

#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <iterator>
#include <optional>
#include <utility>

#include "spikeloop/core/error.hpp"
#include "spikeloop/core/file.hpp"

namespace spikeloop::view {
namespace {

// All that the page needs of the run folder.
constexpr std::string_view kRunFiles[] = {"resolved.json", "world.json", "trajectory.csv",
                                          "episodes.csv", "summary.json"};
constexpr std::string_view kRun = "/run/";
constexpr std::string_view kMissing = "there is no such file, or it is not a regular one";

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

Answer open_answer(const std::string& path, Links links, std::string_view range) {
  Answer answer{.type = type_of(path)};
  try {
    answer.file = Descriptor(open_regular_file(path, "file of a run", links));
  } catch (const FileError&) {
    return error_answer(404, kMissing);
  }
  struct stat status {};
  ::fstat(answer.file.get(), &status);
  const auto size = static_cast<std::uintmax_t>(status.st_size);
  const auto begin = size == 0 ? std::nullopt : begin_of(range);
  if (begin && *begin >= size) {
    Answer refusal = error_answer(416, fmt::format("the file has {} bytes", size));
    refusal.range = fmt::format("bytes */{}", size);
    return refusal;
  }
  answer.status = begin ? 206 : 200;
  answer.range = begin ? fmt::format("bytes {}-{}/{}", *begin, size - 1, size) : "";
  answer.begin = begin.value_or(0);
  answer.size = size - answer.begin;
  return answer;
}

}  // namespace

Answer error_answer(unsigned status, std::string_view text) {
  Answer answer{.status = status, .body = fmt::format("{}\n", text)};
  answer.size = answer.body.size();
  return answer;
}

Answer answer(std::string_view path, std::string_view range, const std::string& page,
              const std::string& run) {
  const bool of_run = path.starts_with(kRun);
  const std::string_view name = of_run        ? path.substr(kRun.size())
                                : path == "/" ? std::string_view("index.html")
                                              : path.substr(1);
  const bool exists =
      of_run ? !run.empty() && std::ranges::find(kRunFiles, name) != std::end(kRunFiles)
             : is_plain_name(name);
  if (!exists) {
    return error_answer(404, kMissing);
  }
  // The run folder may have been written by others; the page may have been installed by links.
  return of_run ? open_answer(fmt::format("{}/{}", run, name), Links::refuse, range)
                : open_answer(fmt::format("{}/{}", page, name), Links::follow, range);
}

std::string next_piece(Answer& answer, std::size_t most) {
  if (answer.file.get() < 0) {
    answer.size = 0;
    return std::exchange(answer.body, {});
  }
  std::string piece(static_cast<std::size_t>(std::min<std::uintmax_t>(answer.size, most)), '\0');
  const ssize_t size =
      ::pread(answer.file.get(), piece.data(), piece.size(), static_cast<off_t>(answer.begin));
  piece.resize(size > 0 ? static_cast<std::size_t>(size) : 0);
  answer.begin += piece.size();
  answer.size -= piece.size();
  return piece;
}

}  // namespace spikeloop::view
