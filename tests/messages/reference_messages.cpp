#include "reference_messages.hpp"

#include "ros1_headers.inc"

#include <boost/array.hpp>
#include <functional>
#include <map>
#include <stdexcept>
#include <type_traits>

namespace reference {
namespace {

/// Goes through a message as a generated serializer does, and puts the contents in.
class Filler {
 public:
  explicit Filler(const std::vector<Atom>& atoms) : atoms_(atoms) {}

  template <typename Message>
  void fill(Message& message) {
    ros::serialization::Serializer<Message>::template allInOne<Filler, Message&>(*this, message);
  }

  template <typename Field>
  std::enable_if_t<std::is_arithmetic_v<Field>> next(Field& field) {
    field = static_cast<Field>(take().number);
  }
  template <typename Field>
  std::enable_if_t<std::is_class_v<Field>> next(Field& field) {
    fill(field);
  }
  void next(std::string& field) { field = take().text; }
  void next(ros::Time& field) {
    next(field.sec);
    next(field.nsec);
  }
  void next(ros::Duration& field) {
    next(field.sec);
    next(field.nsec);
  }
  template <typename Element, typename Allocator>
  void next(std::vector<Element, Allocator>& field) {
    field.resize(static_cast<std::size_t>(take().number));
    for (Element& element : field) {
      next(element);
    }
  }
  template <typename Element, std::size_t kCount>
  void next(boost::array<Element, kCount>& field) {
    for (Element& element : field) {
      next(element);
    }
  }

  bool at_end() const { return next_ == atoms_.size(); }

 private:
  const Atom& take() { return atoms_.at(next_++); }

  const std::vector<Atom>& atoms_;
  std::size_t next_ = 0;
};

template <typename Message>
std::vector<std::uint8_t> serialize_as(const std::vector<Atom>& atoms) {
  Message message;
  Filler filler(atoms);
  filler.fill(message);
  if (!filler.at_end()) {
    throw std::logic_error("the message has fewer fields than it was given");
  }
  std::vector<std::uint8_t> bytes(ros::serialization::serializationLength(message));
  ros::serialization::OStream stream(bytes.data(), static_cast<std::uint32_t>(bytes.size()));
  ros::serialization::serialize(stream, message);
  return bytes;
}

struct Type {
  std::string md5;
  std::string definition;
  std::function<std::vector<std::uint8_t>(const std::vector<Atom>&)> serialize;
};

template <typename Message>
Type type_of() {
  return {ros::message_traits::MD5Sum<Message>::value(),
          ros::message_traits::Definition<Message>::value(), serialize_as<Message>};
}

const std::map<std::string, Type>& all_types() {
  static const std::map<std::string, Type> all = {
#include "ros1_types.inc"
  };
  return all;
}

}  // namespace

std::vector<std::string> types() {
  std::vector<std::string> names;
  for (const auto& [name, type] : all_types()) {
    names.push_back(name);
  }
  return names;
}

std::string md5(const std::string& type) {
  return all_types().at(type).md5;
}

std::string definition(const std::string& type) {
  return all_types().at(type).definition;
}

std::vector<std::uint8_t> serialize(const std::string& type, const std::vector<Atom>& atoms) {
  return all_types().at(type).serialize(atoms);
}

}  // namespace reference
