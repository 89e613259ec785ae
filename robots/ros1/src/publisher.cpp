#include "spikeloop/ros1/publisher.hpp"

#include "session_impl.hpp"
#include "spikeloop/messages/message_writer.hpp"
#include "spikeloop/ros1/raw_publisher.hpp"

namespace spikeloop::ros1 {

struct Publisher::Impl {
  Impl(Session& session, const std::string& topic, const std::string& message_type,
       const std::vector<std::string>& fields)
      : writer(messages::Catalog::for_type(messages::Dialect::ros1, message_type), message_type,
               fields),
        one_array(fields.size() == 1 &&
                  !messages::compile_path(
                       messages::Catalog::for_type(messages::Dialect::ros1, message_type),
                       message_type, fields.front())
                       .width()
                       .has_value()),
        publisher(session, topic, writer.type().name) {}

  void write(std::span<const double> numbers, std::vector<std::byte>& message) {
    values.clear();
    if (one_array) {
      values.push_back({numbers, {}});
    } else {
      for (const double& number : numbers) {
        values.push_back({std::span(&number, 1), {}});
      }
    }
    writer.write(values, message);
  }

  messages::MessageWriter writer;
  bool one_array;
  std::vector<messages::FieldValue> values;  ///< kept from message to message
  std::vector<std::byte> bytes;
  RawPublisher publisher;
};

Publisher::Publisher(Session& session, const std::string& topic, const std::string& message_type,
                     const std::vector<std::string>& fields)
    : impl_(std::make_unique<Impl>(session, topic, message_type, fields)) {}

Publisher::~Publisher() = default;

void Publisher::check(const std::string& topic, const std::string& message_type,
                      const std::vector<std::string>& fields) {
  const messages::MessageWriter writer(
      messages::Catalog::for_type(messages::Dialect::ros1, message_type), message_type, fields);
  check_topic(topic);
}

std::vector<std::byte> Publisher::message(std::span<const double> values) const {
  std::vector<std::byte> bytes;
  impl_->write(values, bytes);
  return bytes;
}

std::span<const std::byte> Publisher::publish(std::span<const double> values) {
  impl_->write(values, impl_->bytes);
  impl_->publisher.publish(impl_->bytes);
  return impl_->bytes;
}

bool Publisher::has_subscribers() const {
  return impl_->publisher.has_subscribers();
}

void Publisher::drain() const {
  impl_->publisher.drain();
}

}  // namespace spikeloop::ros1
