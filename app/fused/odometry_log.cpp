#include "odometry_log.hpp"

#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>

#include "optional_subscriber.hpp"
#include "spikeloop/core/error.hpp"
#include "spikeloop/messages/catalog.hpp"

namespace spikeloop {
namespace {

constexpr const char* kOdometryTopic = "odom";
constexpr const char* kOdometryType = "nav_msgs/Odometry";
constexpr double kSquare_m = 0.5;          // as free cells of a world of ours
constexpr TimeNs kRowPeriod = 20'000'000;  // as of a robot of ours

enum Field { kX, kY, kTurnX, kTurnY, kTurnZ, kTurnW, kSpeedX, kSpeedY, kTurningRate };

std::vector<messages::FieldReader> readers(messages::Dialect dialect) {
  const std::string turn = "pose.pose.orientation.";
  std::vector<messages::FieldReader> result;
  for (const std::string& path :
       {std::string("pose.pose.position.x"), std::string("pose.pose.position.y"), turn + "x",
        turn + "y", turn + "z", turn + "w", std::string("twist.twist.linear.x"),
        std::string("twist.twist.linear.y"), std::string("twist.twist.angular.z")}) {
    result.emplace_back(messages::Catalog::for_type(dialect, kOdometryType), kOdometryType, path);
  }
  return result;
}

double yaw(const std::vector<double>& v) {
  return std::atan2(2 * (v[kTurnW] * v[kTurnZ] + v[kTurnX] * v[kTurnY]),
                    1 - 2 * (v[kTurnY] * v[kTurnY] + v[kTurnZ] * v[kTurnZ]));
}

}  // namespace

OdometryLog::OdometryLog(topics::Session& session, std::string folder, WriteFailures& failures)
    : folder_(std::move(folder)),
      failures_(failures),
      contacts_(session),
      fields_(readers(session.dialect())),
      subscriber_(optional_subscriber(session, {.topic = kOdometryTopic,
                                                .message_type = kOdometryType,
                                                .take = [this](auto message) { take(message); },
                                                // The experiment's sensors report another type.
                                                .refuse = [](const auto&) {}})) {}

/// In the session's thread.
void OdometryLog::take(std::span<const std::byte> message) {
  std::vector<double> v;
  try {
    for (const auto& field : fields_) {
      field.read(message, v);
    }
  } catch (const Error&) {
    return;  // the experiment does not depend on it
  }
  if (!std::isfinite(v[kX]) || !std::isfinite(v[kY])) {
    return;
  }
  const std::lock_guard lock(mutex_);
  newest_ = {.pose = {v[kX], v[kY], yaw(v)},
             .linear_x_m_s = v[kSpeedX],
             .linear_y_m_s = v[kSpeedY],
             .angular_z_rad_s = v[kTurningRate]};
}

void OdometryLog::tick(TimeNs time) {
  contacts_.tick(time);
  if (first_ && time - last_.stamp < kRowPeriod) {
    return;
  }
  std::optional<vehicle::Odometry> now;
  {
    const std::lock_guard lock(mutex_);
    now.swap(newest_);
  }
  if (now) {
    now->stamp = time;
    write(*now);
  }
}

void OdometryLog::write(const vehicle::Odometry& now) {
  if (first_) {
    distance_m_ += std::hypot(now.pose.x_m - last_.pose.x_m, now.pose.y_m - last_.pose.y_m);
  } else {
    first_ = now;
    file_.emplace(folder_, &failures_);
  }
  last_ = now;
  visited_.emplace(std::lround(now.pose.x_m / kSquare_m), std::lround(now.pose.y_m / kSquare_m));
  file_->write(now, contacts_.count());
}

void OdometryLog::close() {
  if (file_) {
    file_->close();
    file_.reset();
  }
}

nlohmann::json OdometryLog::summary() const {
  auto result = nlohmann::json::object();
  if (first_ && last_.stamp > first_->stamp) {
    result = {{"distance_m", distance_m_},
              {"mean_speed_m_s", distance_m_ / to_seconds(last_.stamp - first_->stamp)},
              {"visited_m2", static_cast<double>(visited_.size()) * kSquare_m * kSquare_m}};
  }
  if (const auto collisions = contacts_.count()) {
    result["collisions"] = *collisions;
  }
  return result;
}

}  // namespace spikeloop
