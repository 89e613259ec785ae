// The module spikeloop_python_messages: what python/spikeloop/messages.py calls.
#include <fmt/format.h>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <map>
#include <memory>
#include <utility>

#include "failure.hpp"
#include "spikeloop/bag/reader.hpp"
#include "spikeloop/core/code.hpp"
#include "spikeloop/core/error.hpp"
#include "spikeloop/core/log.hpp"
#include "spikeloop/messages/columns.hpp"

namespace py = pybind11;

namespace spikeloop::python {
namespace {

using messages::Primitive;

/// Collects the warnings that are logged during the lifetime of this object.
class Warnings {
 public:
  Warnings()
      : listener_([this](log::Level level, std::string_view text) {
          if (level >= log::Level::warning) {
            texts.emplace_back(text);
          }
        }) {}

  std::vector<std::string> texts;

 private:
  log::Listener listener_;
};

const char* numpy_type(Primitive primitive) {
  switch (primitive) {
    case Primitive::boolean:
      return "?";
    case Primitive::int8:
      return "i1";
    case Primitive::uint8:
      return "u1";
    case Primitive::int16:
      return "<i2";
    case Primitive::uint16:
      return "<u2";
    case Primitive::int32:
      return "<i4";
    case Primitive::uint32:
      return "<u4";
    case Primitive::int64:
      return "<i8";
    case Primitive::uint64:
      return "<u8";
    case Primitive::float32:
      return "<f4";
    default:
      return "<f8";
  }
}

/// An array that owns these values.
template <typename Value>
py::array array_of(std::vector<Value>&& values, const py::dtype& type) {
  auto* const owned = new std::vector<Value>(std::move(values));
  const py::capsule owner(owned, [](void* all) { delete static_cast<std::vector<Value>*>(all); });
  const auto count = owned->size() * sizeof(Value) / static_cast<std::size_t>(type.itemsize());
  return py::array(type, {count}, owned->data(), owner);
}

py::list texts_of(const std::vector<std::string>& texts) {
  py::list list;
  for (const std::string& text : texts) {
    list.append(py::reinterpret_steal<py::str>(
        PyUnicode_DecodeUTF8(text.data(), static_cast<Py_ssize_t>(text.size()), "replace")));
  }
  return list;
}

/// (path, values, counts of every array on the path)
py::tuple plain(messages::Column&& column) {
  py::list counts;
  for (auto& each : column.counts) {
    counts.append(array_of(std::move(each), py::dtype::of<std::uint32_t>()));
  }
  py::object values = texts_of(column.texts);
  if (column.primitive != Primitive::text) {
    values = array_of(std::move(column.numbers), py::dtype(numpy_type(column.primitive)));
  }
  return py::make_tuple(column.path, values, counts);
}

/// The connection of a topic; of those of a run the node's, or the first.
const bag::Connection& connection_of(const bag::Reader& reader, const std::string& path,
                                     const std::string& topic, const std::string& node) {
  std::vector<const bag::Connection*> found;
  std::string nodes;
  for (const bag::Connection& each : reader.connections()) {
    if (each.topic == topic) {
      nodes += (nodes.empty() ? "" : ", ") + each.node;
      if (node.empty() || each.node == node) {
        found.push_back(&each);
      }
    }
  }
  if (found.empty() && !nodes.empty()) {
    throw ConfigurationError(
        with_code(Code::unknown_node,
                  "'{}': node '{}' has no messages of topic '{}'; nodes with this topic: {}", path,
                  node, topic, nodes));
  }
  if (found.empty()) {
    throw ConfigurationError(with_code(Code::no_such_topic,
                                       "'{}' has no topic '{}'; its topics: {}", path, topic,
                                       bag::list_topics(reader)));
  }
  const bag::Connection& first = *found.front();
  const auto other = std::ranges::find_if(found, [&](const bag::Connection* each) {
    return each->type != first.type || each->dialect != first.dialect;
  });
  if (other != found.end() && !reader.is_of_a_run()) {
    throw ConfigurationError(with_code(Code::wrong_message,
                                       "'{}': topic '{}' has messages of {} and of {}; only "
                                       "messages of one type can be read together",
                                       path, topic, first.type, (*other)->type));
  }
  if (!first.dialect) {
    throw ConfigurationError(
        with_code(Code::wrong_message,
                  "'{}': messages of topic '{}' are encoded as '{}' and defined as '{}'; only "
                  "'ros1' with 'ros1msg', and 'cdr' with 'ros2msg' can be read",
                  path, topic, first.encoding, first.schema.definition_encoding));
  }
  return first;
}

/// With the definition in the file, or with Spikeloop's own if the file's cannot be read.
std::unique_ptr<messages::ColumnReader> columns_of(const bag::Connection& connection,
                                                   const std::vector<std::string>& fields) {
  messages::Catalog catalog(*connection.dialect);
  try {
    catalog.add_with_dependencies(connection.type, connection.schema.definition);
    catalog.layout(connection.type);
  } catch (const ConfigurationError& error) {
    const auto& builtin = messages::Catalog::builtin(*connection.dialect);
    if (!builtin.contains(connection.type)) {
      throw ConfigurationError(with_code(Code::wrong_message,
                                         "topic '{}': the definition of {} in the recording cannot "
                                         "be read: {}",
                                         connection.topic, connection.type, error.what()));
    }
    log::warning(
        "topic '{}': the recording's definition of {} cannot be used; Spikeloop's own is used",
        connection.topic, connection.type);
    return std::make_unique<messages::ColumnReader>(builtin, connection.type, fields);
  }
  return std::make_unique<messages::ColumnReader>(catalog, connection.type, fields);
}

/// (type, times in ns, columns, warnings)
py::tuple read(const std::string& path, const std::string& topic, const std::string& node,
               const std::vector<std::string>& fields) {
  Warnings warnings;
  std::vector<TimeNs> times;
  std::string type;
  std::vector<messages::Column> columns;
  {
    const py::gil_scoped_release free;
    const bag::Reader reader(path);
    const bag::Connection& connection = connection_of(reader, path, topic, node);
    type = connection.type;
    const auto parts = columns_of(connection, fields);
    bag::Stream stream = reader.stream(topic, connection.node);
    while (const auto message = stream.next()) {
      try {
        parts->read(message->bytes);
      } catch (const TransportError& error) {
        throw FileError(fmt::format("'{}': topic '{}', message {}: {}", path, topic,
                                    times.size() + 1, error.what()));
      }
      times.push_back(message->time);
    }
    columns = parts->take_columns();
  }
  py::list plain_columns;
  for (messages::Column& column : columns) {
    plain_columns.append(plain(std::move(column)));
  }
  return py::make_tuple(type, array_of(std::move(times), py::dtype::of<std::int64_t>()),
                        plain_columns, warnings.texts);
}

/// Type of every topic.
std::map<std::string, std::string> topics(const std::string& path) {
  const py::gil_scoped_release free;
  const bag::Reader reader(path);
  std::map<std::string, std::string> found;
  for (const bag::Connection& each : reader.connections()) {
    found.emplace(each.topic, each.type);
  }
  return found;
}

}  // namespace
}  // namespace spikeloop::python

PYBIND11_MODULE(spikeloop_python_messages, module) {
  namespace own = spikeloop::python;
  own::register_failure(module);
  module.def("read", &own::read);
  module.def("topics", &own::topics);
}
