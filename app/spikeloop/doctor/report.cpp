#include "report.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "spikeloop/core/error.hpp"

namespace spikeloop::app::doctor {
namespace {

struct StatusText {
  const char* word;
  const char* colour;  ///< of a terminal: green, yellow, red
};

StatusText text_of(Status status) {
  switch (status) {
    case Status::ok:
      return {"ok", "\x1b[32m"};
    case Status::warning:
      return {"warning", "\x1b[33m"};
    default:
      return {"missing", "\x1b[31m"};
  }
}

std::size_t name_width(const std::vector<Item>& items) {
  constexpr std::size_t kWidest = 24;  // paths of plug-ins are longer: they do not move the others
  std::size_t width = 0;
  for (const Item& item : items) {
    width = std::max(width, std::min(item.name.size(), kWidest));
  }
  return width;
}

std::string line(const Item& item, std::size_t width, bool colour) {
  const StatusText status = text_of(item.finding.status);
  std::string text =
      fmt::format("  {}{:<7}{}  {:<{}}  {}\n", colour ? status.colour : "", status.word,
                  colour ? "\x1b[0m" : "", one_line(item.name), width, one_line(item.finding.text));
  if (!item.finding.remedy.empty()) {
    text += fmt::format("  {:<7}  {:<{}}  -> {}\n", "", "", width, one_line(item.finding.remedy));
  }
  return text;
}

std::string conclusion(const std::vector<Item>& items) {
  std::vector<std::string> absent;
  std::ptrdiff_t other = 0;
  for (const Item& item : items) {
    const bool good = item.finding.status == Status::ok;
    if (item.needed && item.finding.status == Status::missing) {
      absent.push_back(one_line(item.name));
    } else if (!good) {
      ++other;
    }
  }
  const std::string rest =
      other == 0 ? ""
                 : fmt::format("; {} other line{} with a remedy", other, other == 1 ? "" : "s");
  return absent.empty() ? fmt::format("spikeloop run has all that it needs{}\n", rest)
                        : fmt::format("spikeloop run lacks {}{}\n", fmt::join(absent, ", "), rest);
}

}  // namespace

std::vector<Item> examine(const std::vector<Probe>& probes) {
  std::vector<launch::ProgramStart> starts;
  for (const Probe& probe : probes) {
    starts.insert(starts.end(), probe.starts.begin(), probe.starts.end());
  }
  const std::vector<Answer> answers = ask(starts);
  std::vector<Item> items;
  auto begin = answers.begin();
  for (const Probe& probe : probes) {
    const auto end = begin + static_cast<std::ptrdiff_t>(probe.starts.size());
    items.push_back({probe.name, probe.needed, probe.judge({begin, end})});
    begin = end;
  }
  return items;
}

bool ready(const std::vector<Item>& items) {
  return std::ranges::none_of(items, [](const Item& item) {
    return item.needed && item.finding.status == Status::missing;
  });
}

std::string table(const std::vector<Item>& items, bool colour) {
  const std::size_t width = name_width(items);
  std::string text = "Needed by spikeloop run:\n";
  for (const Item& item : items) {
    text += item.needed ? line(item, width, colour) : "";
  }
  text += "\nFor some jobs, or for comfort:\n";
  for (const Item& item : items) {
    text += item.needed ? "" : line(item, width, colour);
  }
  return text + "\n" + conclusion(items);
}

nlohmann::ordered_json data(const std::vector<Item>& items) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const Item& item : items) {
    list.push_back({{"name", one_line(item.name)},
                    {"status", text_of(item.finding.status).word},
                    {"needed", item.needed},
                    {"text", one_line(item.finding.text)},
                    {"remedy", one_line(item.finding.remedy)}});
  }
  return {{"spikeloop", SPIKELOOP_VERSION}, {"ready", ready(items)}, {"items", list}};
}

}  // namespace spikeloop::app::doctor
