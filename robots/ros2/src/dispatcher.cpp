#include "dispatcher.hpp"

#include <algorithm>
#include <array>
#include <span>
#include <utility>

namespace spikeloop::ros2 {

Dispatcher::Dispatcher(dds_entity_t participant)
    : waitset_(dds_create_waitset(participant)), end_(dds_create_guardcondition(participant)) {
  dds_waitset_attach(waitset_, end_, 0);
  thread_ = std::thread([this] { run(); });
}

void Dispatcher::stop() {
  ending_.store(true);
  dds_set_guardcondition(end_, true);
  if (thread_.joinable()) {
    thread_.join();
  }
}

Dispatcher::~Dispatcher() {
  stop();
  dds_delete(waitset_);
  dds_delete(end_);
}

Dispatcher::Ticket Dispatcher::add(dds_entity_t condition, std::function<void()> work) {
  Ticket ticket = 0;
  {
    const std::lock_guard lock(mutex_);
    ticket = ++last_;
    work_[ticket] = std::make_shared<topics::Closable<>>(std::move(work));
  }
  dds_waitset_attach(waitset_, condition, ticket);
  return ticket;
}

void Dispatcher::remove(Ticket ticket, dds_entity_t condition) {
  dds_waitset_detach(waitset_, condition);
  if (const auto work = find(ticket)) {
    work->close();
  }
  const std::lock_guard lock(mutex_);
  work_.erase(ticket);
}

std::shared_ptr<topics::Closable<>> Dispatcher::find(Ticket ticket) {
  const std::lock_guard lock(mutex_);
  const auto found = work_.find(ticket);
  return found == work_.end() ? nullptr : found->second;
}

void Dispatcher::run() {
  std::array<dds_attach_t, 32> tickets{};
  while (!ending_.load()) {
    const dds_return_t count =
        dds_waitset_wait(waitset_, tickets.data(), tickets.size(), DDS_INFINITY);
    const auto ready =
        std::span(tickets).first(std::min<std::size_t>(count < 0 ? 0 : count, tickets.size()));
    std::ranges::sort(ready);
    for (const Ticket ticket : ready) {
      if (const auto work = find(ticket)) {
        work->call();
      }
    }
  }
}

}  // namespace spikeloop::ros2
