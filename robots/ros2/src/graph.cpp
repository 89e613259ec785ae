#include "graph.hpp"

#include <array>
#include <cstring>
#include <utility>

#include "qos.hpp"

namespace spikeloop::ros2 {
namespace {

std::string user_data_of(const dds_qos_t* qos) {
  void* data = nullptr;
  std::size_t size = 0;
  if (!dds_qget_userdata(qos, &data, &size) || data == nullptr) {
    return {};
  }
  std::string text(static_cast<const char*>(data), size);
  dds_free(data);
  return text;
}

bool is_alive(const dds_sample_info_t& info) {
  return info.valid_data && info.instance_state == DDS_IST_ALIVE;
}

/// Calls `record` for the next reports of a built-in reader.
void take_endpoints(dds_entity_t reader, const auto& record) {
  std::array<void*, 16> samples{};
  std::array<dds_sample_info_t, 16> infos{};
  const dds_return_t count =
      dds_take(reader, samples.data(), infos.data(), samples.size(), samples.size());
  for (dds_return_t i = 0; i < count; ++i) {
    record(*static_cast<const dds_builtintopic_endpoint_t*>(samples[i]), infos[i]);
  }
  if (count > 0) {
    dds_return_loan(reader, samples.data(), count);
  }
}

template <typename Endpoint>
std::vector<Endpoint> endpoints_of(const std::map<dds_instance_handle_t, Endpoint>& all,
                                   const std::string& dds_topic) {
  std::vector<Endpoint> found;
  for (const auto& [handle, endpoint] : all) {
    if (endpoint.topic == dds_topic) {
      found.push_back(endpoint);
    }
  }
  return found;
}

}  // namespace

bool is_same(const dds_guid_t& a, const dds_guid_t& b) {
  return std::memcmp(a.v, b.v, sizeof a.v) == 0;
}

Graph::Graph(dds_entity_t participant, Dispatcher& dispatcher)
    : dispatcher_(dispatcher),
      reader_(dds_create_reader(participant, DDS_BUILTIN_TOPIC_DCPSPUBLICATION, nullptr, nullptr)),
      news_(dds_create_readcondition(reader_, DDS_ANY_STATE)),
      subscriptions_(
          dds_create_reader(participant, DDS_BUILTIN_TOPIC_DCPSSUBSCRIPTION, nullptr, nullptr)),
      readers_news_(dds_create_readcondition(subscriptions_, DDS_ANY_STATE)),
      fresh_(dds_create_guardcondition(participant)) {
  news_ticket_ = dispatcher_.add(news_, [this] { take_news(); });
  readers_ticket_ = dispatcher_.add(readers_news_, [this] { take_readers(); });
  fresh_ticket_ = dispatcher_.add(fresh_, [this] { tell_fresh(); });
}

Graph::~Graph() {
  dispatcher_.remove(news_ticket_, news_);
  dispatcher_.remove(readers_ticket_, readers_news_);
  dispatcher_.remove(fresh_ticket_, fresh_);
  dds_delete(fresh_);
  dds_delete(subscriptions_);
  dds_delete(reader_);
}

Graph::Listener Graph::listen(const std::string& dds_topic, Seen seen) {
  const std::lock_guard lock(mutex_);
  listeners_[++last_] = {
      .topic = dds_topic,
      .seen = std::make_shared<topics::Closable<const Writer&, bool>>(std::move(seen))};
  dds_set_guardcondition(fresh_, true);
  return last_;
}

void Graph::forget(Listener listener) {
  std::shared_ptr<topics::Closable<const Writer&, bool>> seen;
  {
    const std::lock_guard lock(mutex_);
    seen = listeners_.at(listener).seen;
    listeners_.erase(listener);
  }
  seen->close();
}

std::vector<OtherReader> Graph::readers(const std::string& dds_topic) const {
  const std::lock_guard lock(mutex_);
  return endpoints_of(readers_, dds_topic);
}

std::vector<Writer> Graph::writers(const std::string& dds_topic) const {
  const std::lock_guard lock(mutex_);
  return endpoints_of(writers_, dds_topic);
}

/// Records all of them before it calls a listener: a listener sees the whole topic.
void Graph::take_news() {
  std::vector<std::pair<Writer, bool>> news;
  take_endpoints(reader_,
                 [&](const auto& endpoint, const auto& info) { record(endpoint, info, news); });
  for (const auto& [writer, alive] : news) {
    tell(writer, alive);
  }
}

void Graph::record(const dds_builtintopic_endpoint_t& endpoint, const dds_sample_info_t& info,
                   std::vector<std::pair<Writer, bool>>& news) {
  const std::lock_guard lock(mutex_);
  if (!is_alive(info)) {
    if (const auto left = writers_.extract(info.instance_handle); !left.empty()) {
      news.emplace_back(left.mapped(), false);
    }
    return;
  }
  const Writer writer{.topic = endpoint.topic_name,
                      .type = endpoint.type_name,
                      .user_data = user_data_of(endpoint.qos),
                      .reliable = is_reliable(endpoint.qos),
                      .misfit = offer_misfit(endpoint.qos),
                      .latched = is_latched(endpoint.qos),
                      .handle = info.instance_handle,
                      .guid = endpoint.key,
                      .participant = endpoint.participant_key};
  writers_[info.instance_handle] = writer;
  news.emplace_back(writer, true);
}

void Graph::take_readers() {
  take_endpoints(subscriptions_, [this](const auto& endpoint, const auto& info) {
    const std::lock_guard lock(mutex_);
    if (!is_alive(info)) {
      readers_.erase(info.instance_handle);
      return;
    }
    readers_[info.instance_handle] = {.topic = endpoint.topic_name,
                                      .type = endpoint.type_name,
                                      .requests = requests_of(endpoint.qos),
                                      .guid = endpoint.key};
  });
}

void Graph::tell(const Writer& writer, bool alive) {
  std::vector<std::shared_ptr<topics::Closable<const Writer&, bool>>> told;
  {
    const std::lock_guard lock(mutex_);
    for (const auto& [id, listening] : listeners_) {
      if (!listening.fresh && listening.topic == writer.topic) {
        told.push_back(listening.seen);
      }
    }
  }
  for (const auto& seen : told) {
    seen->call(writer, alive);
  }
}

void Graph::tell_fresh() {
  dds_set_guardcondition(fresh_, false);
  std::vector<std::pair<std::shared_ptr<topics::Closable<const Writer&, bool>>, Writer>> told;
  {
    const std::lock_guard lock(mutex_);
    for (auto& [id, listening] : listeners_) {
      for (const auto& [handle, writer] : writers_) {
        if (listening.fresh && listening.topic == writer.topic) {
          told.emplace_back(listening.seen, writer);
        }
      }
      listening.fresh = false;
    }
  }
  for (const auto& [seen, writer] : told) {
    seen->call(writer, true);
  }
}

}  // namespace spikeloop::ros2
