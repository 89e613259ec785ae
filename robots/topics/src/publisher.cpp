#include "spikeloop/topics/publisher.hpp"

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

}  // namespace

struct Publisher::Impl {
  Impl(Session& session, const std::string& topic, const std::string& message_type,
       const std::vector<std::string>& fields)
      : writer(messages::Catalog::for_type(session.dialect(), message_type), message_type, fields),
        one_array(is_one_array(messages::Catalog::for_type(session.dialect(), message_type),
                               message_type, fields)) {
    check_topic(session.dialect(), topic);
    publisher = session.publisher(topic, message_type);
  }

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
  std::unique_ptr<RawPublisher> publisher;
};

Publisher::Publisher(Session& session, const std::string& topic, const std::string& message_type,
                     const std::vector<std::string>& fields)
    : impl_(std::make_unique<Impl>(session, topic, message_type, fields)) {}

Publisher::~Publisher() = default;

void Publisher::check(messages::Dialect ros, const std::string& topic,
                      const std::string& message_type, const std::vector<std::string>& fields) {
  const messages::MessageWriter writer(messages::Catalog::for_type(ros, message_type), message_type,
                                       fields);
  check_topic(ros, topic);
}

std::vector<std::byte> Publisher::message(std::span<const double> values) const {
  std::vector<std::byte> bytes;
  impl_->write(values, bytes);
  return bytes;
}

std::span<const std::byte> Publisher::publish(std::span<const double> values) {
  impl_->write(values, impl_->bytes);
  impl_->publisher->publish(impl_->bytes);
  return impl_->bytes;
}

bool Publisher::has_subscribers() const {
  return impl_->publisher->has_subscribers();
}

std::string Publisher::misfit() const {
  return impl_->publisher->misfit();
}

void Publisher::drain() const {
  impl_->publisher->drain();
}

}  // namespace spikeloop::topics
