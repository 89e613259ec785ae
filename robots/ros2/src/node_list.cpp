#include "node_list.hpp"

#include <algorithm>
#include <array>
#include <cstring>
#include <string_view>
#include <utility>

#include "qos.hpp"
#include "spikeloop/core/log.hpp"

namespace spikeloop::ros2 {
namespace {

/// Largest number of messages read per wake-up of the session's thread.
constexpr int kMostLists = 16;

constexpr std::size_t kGidUntilHumble = 24;
constexpr std::size_t kGidSinceIron = 16;
constexpr std::array<std::pair<std::string_view, std::size_t>, 8> kDistributions{
    {{"foxy", kGidUntilHumble},
     {"galactic", kGidUntilHumble},
     {"humble", kGidUntilHumble},
     {"iron", kGidSinceIron},
     {"jazzy", kGidSinceIron},
     {"kilted", kGidSinceIron},
     {"lyrical", kGidSinceIron},
     {"rolling", kGidSinceIron}}};
/// Of rmw_dds_common/ParticipantEntitiesInfo since Iron (REP 2016).
constexpr const char* kHashSinceIron =
    "typehash=RIHS01_91a0593bacdcc50ea9bdcf849a938b128412cc1ea821245c663bcd26f83c295e;";

/// XCDR1, little endian, for what this message has.
class Encoder {
 public:
  explicit Encoder(std::size_t gid_bytes) : gid_bytes_(gid_bytes) {}

  void number(std::uint32_t value) {
    bytes_.resize((bytes_.size() + 3) / 4 * 4);
    const auto* data = reinterpret_cast<const std::byte*>(&value);
    bytes_.insert(bytes_.end(), data, data + sizeof value);
  }
  void text(const std::string& value) {
    number(static_cast<std::uint32_t>(value.size() + 1));
    const auto* data = reinterpret_cast<const std::byte*>(value.c_str());
    bytes_.insert(bytes_.end(), data, data + value.size() + 1);
  }
  void gid(const Gid& value) {
    const auto* data = reinterpret_cast<const std::byte*>(value.v);
    bytes_.insert(bytes_.end(), data, data + sizeof value.v);
    bytes_.resize(bytes_.size() + gid_bytes_ - sizeof value.v);
  }
  void gids(std::span<const Gid> values) {
    number(static_cast<std::uint32_t>(values.size()));
    for (const Gid& value : values) {
      gid(value);
    }
  }
  std::vector<std::byte> take() { return std::move(bytes_); }

 private:
  std::size_t gid_bytes_;
  std::vector<std::byte> bytes_{std::byte{0}, std::byte{1}, std::byte{0}, std::byte{0}};
};

/// The reverse of Encoder. Its functions return false at the end of the message.
class Decoder {
 public:
  Decoder(std::span<const std::byte> message, std::size_t gid_bytes)
      : fields_(message.subspan(kEncodingBytes)), gid_bytes_(gid_bytes) {}

  /// nullopt if the identities have another length.
  std::optional<std::vector<NodeEndpoints>> nodes() {
    Gid participant{};
    std::uint32_t count = 0;
    std::vector<NodeEndpoints> nodes;
    bool good = gid(participant) && number(count);
    for (std::uint32_t i = 0; good && i < count; ++i) {
      NodeEndpoints node;
      std::string space;
      std::string name;
      good = text(space) && text(name) && gids(node.endpoints) && gids(node.endpoints);
      node.name = (space == "/" ? space : space + "/") + name;
      nodes.push_back(std::move(node));
    }
    return good && fields_.size() - at_ < 4 ? std::optional(std::move(nodes)) : std::nullopt;
  }

 private:
  bool has(std::size_t size) const { return size <= fields_.size() - at_; }
  bool number(std::uint32_t& value) {
    at_ = std::min((at_ + 3) / 4 * 4, fields_.size());
    if (!has(sizeof value)) {
      return false;
    }
    std::memcpy(&value, fields_.data() + at_, sizeof value);
    at_ += sizeof value;
    return true;
  }
  bool text(std::string& value) {
    std::uint32_t size = 0;
    if (!number(size) || size == 0 || !has(size)) {
      return false;
    }
    value.assign(reinterpret_cast<const char*>(fields_.data()) + at_, size - 1);
    at_ += size;
    return value.find('\0') == std::string::npos;
  }
  bool gid(Gid& value) {
    if (!has(gid_bytes_)) {
      return false;
    }
    std::memcpy(value.v, fields_.data() + at_, sizeof value.v);
    at_ += gid_bytes_;
    return true;
  }
  bool gids(std::vector<Gid>& values) {
    std::uint32_t count = 0;
    bool good = number(count) && has(count * std::size_t{gid_bytes_});
    for (std::uint32_t i = 0; good && i < count; ++i) {
      good = gid(values.emplace_back());
    }
    return good;
  }

  std::span<const std::byte> fields_;
  std::size_t gid_bytes_;
  std::size_t at_ = 0;
};

Gid gid_of(dds_entity_t entity) {
  Gid gid{};
  dds_get_guid(entity, &gid);
  return gid;
}

}  // namespace

std::optional<std::size_t> gid_bytes_of(const std::string& distribution) {
  const auto found = std::find_if(kDistributions.begin(), kDistributions.end(),
                                  [&](const auto& entry) { return entry.first == distribution; });
  return found == kDistributions.end() ? std::nullopt : std::optional(found->second);
}

std::vector<std::byte> node_message(const Gid& participant, const NodeIdentity& node,
                                    std::span<const Gid> readers, std::span<const Gid> writers,
                                    std::size_t gid_bytes) {
  Encoder encoder(gid_bytes);
  encoder.gid(participant);
  encoder.number(1);
  encoder.text(node.space);
  encoder.text(node.name);
  encoder.gids(readers);
  encoder.gids(writers);
  return encoder.take();
}

std::vector<NodeEndpoints> read_nodes(std::span<const std::byte> message) {
  for (const std::size_t gid_bytes : {kGidSinceIron, kGidUntilHumble}) {
    if (auto nodes = Decoder(message, gid_bytes).nodes()) {
      return std::move(*nodes);
    }
  }
  return {};
}

NodeList::NodeList(dds_entity_t participant, const RawTopic& topic, Graph& graph,
                   Dispatcher& dispatcher, const NodeIdentity& node,
                   const std::string& distribution)
    : participant_(participant),
      topic_(topic),
      graph_(graph),
      node_(node),
      own_(gid_of(participant)),
      gid_bytes_(gid_bytes_of(distribution)),
      dispatcher_(dispatcher),
      reader_(dds_create_reader(participant, topic.entity, reader_qos(0, true, true, "").get(),
                                nullptr)),
      arrived_(dds_create_readcondition(reader_, DDS_ANY_STATE)),
      ticket_(dispatcher_.add(arrived_, [this] { take_names(); })) {
  if (gid_bytes_) {
    begin();
  }
  listener_ = graph_.listen(kTopic, [this](const Writer& writer, bool alive) {
    if (alive) {
      hear_of(writer);
    } else {
      const std::lock_guard lock(mutex_);
      others_.erase(writer.handle);
    }
  });
}

NodeList::~NodeList() {
  graph_.forget(listener_);
  dispatcher_.remove(ticket_, arrived_);
  dds_delete(reader_);
  if (writer_ > 0) {
    dds_delete(writer_);
  }
}

void NodeList::add_reader(dds_entity_t reader) {
  add(reader, false);
}

void NodeList::add_writer(dds_entity_t writer) {
  add(writer, true);
}

void NodeList::add(dds_entity_t endpoint, bool writes) {
  const std::lock_guard lock(mutex_);
  entries_.push_back({.endpoint = endpoint, .gid = gid_of(endpoint), .writes = writes});
  tell();
}

void NodeList::remove(dds_entity_t endpoint) {
  const std::lock_guard lock(mutex_);
  std::erase_if(entries_, [&](const Entry& entry) { return entry.endpoint == endpoint; });
  tell();
}

void NodeList::hear_of(const Writer& writer) {
  if (writer.type != kType || is_same(writer.participant, own_)) {
    return;
  }
  const bool has_hash = writer.user_data.find("typehash=") != std::string::npos;
  const std::size_t bytes = has_hash ? kGidSinceIron : kGidUntilHumble;
  const std::lock_guard lock(mutex_);
  if (disagreed_ || gid_bytes_ == bytes) {
    return;
  }
  if (!gid_bytes_) {
    gid_bytes_ = bytes;
    begin();
    tell();
    return;
  }
  disagreed_ = true;
  if (writer_ > 0) {
    dds_delete(std::exchange(writer_, 0));
  }
  log::warning(
      "nodes of ROS 2 until Humble and since Iron are in one domain, or ROS_DISTRO is not theirs: "
      "node {} is not in `ros2 node list`, which would harm one of them; its topics work",
      node_.whole());
}

void NodeList::take_names() {
  for (int i = 0; i < kMostLists; ++i) {
    const TakenMessage taken(reader_);
    if (!taken.any()) {
      return;
    }
    if (taken.valid()) {
      auto nodes = read_nodes(taken.message());
      const std::lock_guard lock(mutex_);
      others_[taken.writer()] = std::move(nodes);
    }
  }
}

std::string NodeList::node_of(const Gid& endpoint) const {
  const std::lock_guard lock(mutex_);
  for (const auto& [writer, nodes] : others_) {
    for (const NodeEndpoints& node : nodes) {
      if (std::ranges::any_of(node.endpoints,
                              [&](const Gid& gid) { return is_same(gid, endpoint); })) {
        return node.name;
      }
    }
  }
  return {};
}

/// The newest message for all that come, as ROS 2 has it.
void NodeList::begin() {
  const Qos qos = writer_qos(1, true, gid_bytes_ == kGidSinceIron ? kHashSinceIron : "");
  writer_ = dds_create_writer(participant_, topic_.entity, qos.get(), nullptr);
}

void NodeList::tell() {
  if (writer_ <= 0) {
    return;
  }
  std::vector<Gid> readers;
  std::vector<Gid> writers;
  for (const Entry& entry : entries_) {
    (entry.writes ? writers : readers).push_back(entry.gid);
  }
  write_raw(writer_, topic_, node_message(own_, node_, readers, writers, *gid_bytes_));
}

}  // namespace spikeloop::ros2
