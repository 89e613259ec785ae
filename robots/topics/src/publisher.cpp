#include "spikeloop/topics/publisher.hpp"

#include <algorithm>
#include <array>
#include <chrono>

#include "spikeloop/messages/catalog.hpp"
#include "spikeloop/messages/message_writer.hpp"
#include "spikeloop/topics/names.hpp"

namespace spikeloop::topics {
namespace {

bool is_one_array(const messages::Catalog& catalog, const std::string& message_type,
                  const std::vector<std::string>& fields) {
  return fields.size() == 1 &&
         !messages::compile_path(catalog, message_type, fields.front()).width().has_value();
}

bool has_free_header(const messages::Catalog& catalog, const std::string& message_type,
                     const std::vector<std::string>& fields) {
  const auto layout = catalog.layout(catalog.full_name(message_type));
  const bool has_header = std::ranges::any_of(layout->fields, [](const auto& field) {
    return field.name == "header" && field.message && field.message->name == "std_msgs/Header";
  });
  return has_header && std::ranges::none_of(fields, [](const std::string& path) {
           return path.starts_with("header.");
         });
}

/// Appends the stamp to the fields of the values.
std::vector<std::string> with_stamp(std::vector<std::string> fields, bool stamped) {
  if (stamped) {
    fields.insert(fields.end(), {"header.stamp.secs", "header.stamp.nsecs"});
  }
  return fields;
}

/// Wall time since 1970: whole seconds, and the remaining nanoseconds.
std::array<double, 2> wall_time() {
  const auto now = std::chrono::system_clock::now().time_since_epoch();
  const auto seconds = std::chrono::floor<std::chrono::seconds>(now);
  return {static_cast<double>(seconds.count()),
          static_cast<double>(std::chrono::nanoseconds(now - seconds).count())};
}

}  // namespace

struct Publisher::Impl {
  Impl(Session& session, const messages::Catalog& catalog, const std::string& topic,
       const std::string& message_type, const std::vector<std::string>& fields, bool wants_stamp)
      : stamped(wants_stamp && has_free_header(catalog, message_type, fields)),
        writer(catalog, message_type, with_stamp(fields, stamped)),
        one_array(is_one_array(catalog, message_type, fields)) {
    check_topic(session.dialect(), topic);
    publisher = session.publisher(topic, message_type);
  }

  void write(std::span<const double> numbers, const std::array<double, 2>& stamp,
             std::vector<messages::FieldValue>& fields, std::vector<std::byte>& message) const {
    fields.clear();
    if (one_array) {
      fields.push_back({numbers, {}});
    } else {
      for (const double& number : numbers) {
        fields.push_back({std::span(&number, 1), {}});
      }
    }
    if (stamped) {
      fields.push_back({std::span(stamp).first(1), {}});
      fields.push_back({std::span(stamp).last(1), {}});
    }
    writer.write(fields, message);
  }

  bool stamped;
  messages::MessageWriter writer;
  bool one_array;
  std::vector<messages::FieldValue> values;  ///< reused for every message
  std::vector<std::byte> bytes;
  std::unique_ptr<RawPublisher> publisher;
};

Publisher::Publisher(Session& session, const std::string& topic, const std::string& message_type,
                     const std::vector<std::string>& fields, bool stamped)
    : impl_(std::make_unique<Impl>(session,
                                   messages::Catalog::for_type(session.dialect(), message_type),
                                   topic, message_type, fields, stamped)) {}

Publisher::~Publisher() = default;

void Publisher::check(messages::Dialect ros, const std::string& topic,
                      const std::string& message_type, const std::vector<std::string>& fields) {
  const messages::MessageWriter writer(messages::Catalog::for_type(ros, message_type), message_type,
                                       fields);
  check_topic(ros, topic);
}

std::vector<std::byte> Publisher::message(std::span<const double> values) const {
  std::vector<messages::FieldValue> fields;
  std::vector<std::byte> bytes;
  impl_->write(values, {}, fields, bytes);
  return bytes;
}

std::span<const std::byte> Publisher::publish(std::span<const double> values) {
  impl_->write(values, impl_->stamped ? wall_time() : std::array<double, 2>{}, impl_->values,
               impl_->bytes);
  impl_->publisher->publish(impl_->bytes);
  return impl_->bytes;
}

const RawPublisher& Publisher::raw() const {
  return *impl_->publisher;
}

}  // namespace spikeloop::topics
