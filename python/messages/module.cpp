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
#include "spikeloop/images/pixels.hpp"
#include "spikeloop/messages/columns.hpp"
#include "spikeloop/messages/number.hpp"

namespace py = pybind11;

namespace spikeloop::python {
namespace {

using messages::Primitive;

/// Type of NumPy for a number. Times are float64.
std::string numpy_type(Primitive primitive) {
  return with_number(
      messages::is_time(primitive) ? Primitive::float64 : primitive, []<typename T>(T /*type*/) {
        return std::is_same_v<T, bool> ? std::string("?")
                                       : fmt::format("<{}{}",
                                                     std::is_floating_point_v<T> ? 'f'
                                                     : std::is_signed_v<T>       ? 'i'
                                                                                 : 'u',
                                                     sizeof(T));
      });
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
  if (!node.empty() && !reader.is_of_a_run()) {
    throw ConfigurationError(
        with_code(Code::unknown_node,
                  "'{}' was not written by a run, so it has no nodes; omit 'node'", path));
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

/// (type, times in ns, columns, warnings)
py::tuple read(const std::string& path, const std::string& topic, const std::string& node,
               const std::vector<std::string>& fields) {
  std::vector<std::string> warnings;
  std::vector<TimeNs> times;
  std::string type;
  std::vector<messages::Column> columns;
  {
    const py::gil_scoped_release free;
    const bag::Reader reader(path);
    const bag::Connection& connection = connection_of(reader, path, topic, node);
    type = connection.type;
    messages::RecordedLayout layout = messages::layout_of(
        bag::recorded_topic(reader, connection, connection.node), *connection.dialect);
    warnings = reader.warnings();
    warnings.insert(warnings.end(), layout.warnings.begin(), layout.warnings.end());
    messages::ColumnReader parts(std::move(layout.type), fields);
    bag::Stream stream = reader.stream(topic, connection.node);
    while (const auto message = stream.next()) {
      try {
        parts.read(message->bytes);
      } catch (const TransportError& error) {
        throw FileError(fmt::format("'{}': topic '{}', message {}: {}", path, topic,
                                    times.size() + 1, error.what()));
      }
      times.push_back(message->time);
    }
    columns = parts.take_columns();
  }
  py::list plain_columns;
  for (messages::Column& column : columns) {
    plain_columns.append(plain(std::move(column)));
  }
  return py::make_tuple(type, array_of(std::move(times), py::dtype::of<std::int64_t>()),
                        plain_columns, warnings);
}

/// Returns (type of every topic, warnings).
py::tuple topics(const std::string& path) {
  std::map<std::string, std::string> found;
  std::vector<std::string> warnings;
  {
    const py::gil_scoped_release free;
    const bag::Reader reader(path);
    for (const bag::Connection& each : reader.connections()) {
      found.emplace(each.topic, each.type);
    }
    warnings = reader.warnings();
  }
  return py::make_tuple(found, warnings);
}

using Data = py::array_t<std::uint8_t, py::array::c_style | py::array::forcecast>;

std::span<const std::byte> bytes_of(const Data& data) {
  return std::as_bytes(std::span(data.data(), static_cast<std::size_t>(data.size())));
}

/// Array of height x width (x components).
py::array array_of(images::Pixels&& pixels) {
  std::vector<py::ssize_t> shape{pixels.height, pixels.width};
  if (pixels.components > 1) {
    shape.push_back(static_cast<py::ssize_t>(pixels.components));
  }
  return array_of(std::move(pixels.samples), py::dtype(pixels.type)).reshape(shape);
}

py::array image(const std::string& encoding, std::uint32_t height, std::uint32_t width,
                std::uint32_t step, bool is_big_endian, const Data& data) {
  return array_of(
      images::read_pixels({width, height, step, encoding, is_big_endian, bytes_of(data)}));
}

py::array compressed_image(const std::string& format, const Data& data) {
  return array_of(images::read_compressed_pixels(bytes_of(data), format));
}

}  // namespace
}  // namespace spikeloop::python

PYBIND11_MODULE(spikeloop_python_messages, module) {
  namespace own = spikeloop::python;
  own::register_failure(module);
  module.def("read", &own::read);
  module.def("topics", &own::topics);
  module.def("image", &own::image);
  module.def("compressed_image", &own::compressed_image);
}
