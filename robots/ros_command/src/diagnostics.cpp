#include "diagnostics.hpp"

#include <fmt/format.h>

#include <chrono>

#include "spikeloop/messages/catalog.hpp"

namespace spikeloop::ros_command {
namespace {

constexpr const char* kType = "diagnostic_msgs/DiagnosticArray";
constexpr TimeNs kPeriod = kNsPerSecond;
constexpr TimeNs kLeastPeriod = 100'000'000;

std::vector<std::string> paths(std::size_t values) {
  std::vector<std::string> result{"header.stamp", "status[0].level", "status[0].name",
                                  "status[0].message"};
  for (std::size_t i = 0; i < values; ++i) {
    result.push_back(fmt::format("status[0].values[{}].key", i));
    result.push_back(fmt::format("status[0].values[{}].value", i));
  }
  return result;
}

}  // namespace

Diagnostics::Diagnostics(topics::Session& session, const std::string& topic)
    : name_("spikeloop: commands on " + session.whole_topic(topic)),
      dialect_(session.dialect()),
      publisher_(session.publisher("/diagnostics", kType)) {}

TimeNs Diagnostics::publish(TimeNs now, const command::Condition& condition,
                            const command::CommandSink& sink) {
  const bool changed = condition.text != told_.text && now - sent_ >= kLeastPeriod;
  if (changed || now - sent_ >= kPeriod) {
    sent_ = now;
    told_ = condition;
    write(sink.counters());
    publisher_->publish(message_);
  }
  return now + kLeastPeriod;
}

void Diagnostics::write(const std::vector<Counter>& counters) {
  if (!writer_) {
    writer_.emplace(messages::Catalog::builtin(dialect_), kType, paths(counters.size()));
  }
  const std::chrono::duration<double> since_1970 =
      std::chrono::system_clock::now().time_since_epoch();
  const double stamp = since_1970.count();
  const auto level = static_cast<double>(told_.level);
  std::vector<std::string> numbers;
  numbers.reserve(counters.size());  // the texts below refer to them
  std::vector<messages::FieldValue> values{
      {.numbers = {&stamp, 1}}, {.numbers = {&level, 1}}, {.text = name_}, {.text = told_.text}};
  for (const Counter& counter : counters) {
    values.push_back({.text = counter.name});
    values.push_back({.text = numbers.emplace_back(std::to_string(counter.value))});
  }
  writer_->write(values, message_);
}

}  // namespace spikeloop::ros_command
