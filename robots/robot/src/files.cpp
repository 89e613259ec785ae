#include "spikeloop/robot/files.hpp"
#include "spikeloop/core/file.hpp"

#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "spikeloop/core/error.hpp"
#include "spikeloop/core/pacer.hpp"

namespace spikeloop::robot {
namespace {

/// Of wall time: the live view draws the path from the file.
constexpr TimeNs kFlushPeriod = kNsPerSecond / 20;

std::string in_directory(const std::string& directory, const char* name) {
  std::error_code error;
  std::filesystem::create_directories(directory, error);
  if (error) throw FileError("make directory", directory, error.value());
  return (std::filesystem::path(directory) / name).string();
}

nlohmann::json describe(const vehicle::Obstacle& obstacle) {
  nlohmann::json result{{"name", obstacle.name},
                        {"x_m", obstacle.x_m},
                        {"y_m", obstacle.y_m},
                        {"theta_rad", obstacle.theta_rad}};
  if (obstacle.height_m > 0) result["height_m"] = obstacle.height_m;
  if (obstacle.shape == vehicle::Obstacle::Shape::box) {
    result["shape"] = "box";
    result["half_x_m"] = obstacle.half_x_m;
    result["half_y_m"] = obstacle.half_y_m;
  } else {
    result["shape"] = "cylinder";
    result["radius_m"] = obstacle.radius_m;
  }
  return result;
}

/// Where a geom ends above, in the world's frame; of other shapes than boxes and cylinders not
/// less than that.
double top_m(const mjModel& model, const mjData& data, int geom) {
  const mjtNum* size = model.geom_size + 3 * geom;
  const mjtNum* up = data.geom_xmat + 9 * geom + 6;  // the world's z in the geom's frame
  double reach = model.geom_rbound[geom];
  if (model.geom_type[geom] == mjGEOM_BOX) {
    reach = std::abs(up[0]) * size[0] + std::abs(up[1]) * size[1] + std::abs(up[2]) * size[2];
  } else if (model.geom_type[geom] == mjGEOM_CYLINDER) {
    reach = std::hypot(up[0], up[1]) * size[0] + std::abs(up[2]) * size[1];
  }
  return data.geom_xpos[3 * geom + 2] + reach;
}

/// The top of the highest of the geoms that `picks` picks; 0 when it picks none.
template <typename Picks>
double height_m(const mjModel& model, const mjData& data, Picks&& picks) {
  double height = 0;
  for (int geom = 0; geom < model.ngeom; ++geom) {
    if (picks(geom)) height = std::max(height, top_m(model, data, geom));
  }
  return height;
}

/// Of what stands outside the walls' inner faces and can be collided with.
double wall_height_m(const mjModel& model, const mjData& data, const vehicle::Arena& arena) {
  return height_m(model, data, [&](int geom) {
    const mjtNum* at = data.geom_xpos + 3 * geom;
    const bool inside = at[0] > arena.min_x_m && at[0] < arena.max_x_m && at[1] > arena.min_y_m &&
                        at[1] < arena.max_y_m;
    const bool solid = model.geom_contype[geom] != 0 || model.geom_conaffinity[geom] != 0;
    return solid && !inside && model.geom_type[geom] != mjGEOM_PLANE;
  });
}

double vehicle_height_m(const mjModel& model, const mjData& data) {
  const int vehicle = mj_name2id(&model, mjOBJ_BODY, "vehicle");
  return height_m(model, data,
                  [&](int geom) { return model.body_rootid[model.geom_bodyid[geom]] == vehicle; });
}

/// Sites "lamp_*", which shine. Their height is that of the bodies that hold them.
nlohmann::json lamps_of(const mjModel& model, const mjData& data) {
  nlohmann::json lamps = nlohmann::json::array();
  for (int site = 0; site < model.nsite; ++site) {
    const std::string name = model.names + model.name_siteadr[site];
    if (name.starts_with("lamp_")) {
      const mjtNum* at = data.site_xpos + 3 * site;
      const int body = model.site_bodyid[site];
      const double height = height_m(
          model, data, [&](int geom) { return body != 0 && model.geom_bodyid[geom] == body; });
      lamps.push_back({{"name", name},
                       {"x_m", at[0]},
                       {"y_m", at[1]},
                       {"height_m", std::max<double>(height, at[2])}});
    }
  }
  return lamps;
}

nlohmann::json describe(const std::vector<vehicle::Obstacle>& footprints) {
  nlohmann::json all = nlohmann::json::array();
  for (const vehicle::Obstacle& footprint : footprints) all.push_back(describe(footprint));
  return all;
}

}  // namespace

RowFile::RowFile(std::string path, const std::string& head, WriteFailures* failures)
    : path_(std::move(path)), failures_(failures) {
  file_.reset(::fdopen(create_file(path_), "wb"));
  if (!file_) throw FileError("write", path_, errno);
  write(head + "\n");
}

template <typename Work>
void RowFile::attempt(Work&& work) {
  if (!file_) return;
  try {
    require_not_deleted(::fileno(file_.get()), path_);
    errno = 0;
    if (!work()) throw FileError("write", path_, errno != 0 ? errno : EIO);
  } catch (const FileError& error) {
    file_.reset();
    if (failures_ == nullptr) throw;
    failures_->add(path_, error.what());
  }
}

void RowFile::write(const std::string& row) {
  attempt([&] { return std::fwrite(row.data(), 1, row.size(), file_.get()) == row.size(); });
}

void RowFile::flush() {
  attempt([&] { return std::fflush(file_.get()) == 0; });
}

void RowFile::close() {
  attempt([&] { return std::fclose(file_.release()) == 0; });
}

TrajectoryFile::TrajectoryFile(const std::string& directory, WriteFailures* failures)
    : file_(in_directory(directory, "trajectory.csv"),
            "t_s,x_m,y_m,theta_rad,v_m_s,w_rad_s,collisions", failures) {}

void TrajectoryFile::write(const vehicle::Odometry& odometry,
                           std::optional<std::uint64_t> collisions) {
  file_.write(fmt::format("{:.3f},{:.6f},{:.6f},{:.6f},{:.6f},{:.6f},{}\n",
                          to_seconds(odometry.stamp), odometry.pose.x_m, odometry.pose.y_m,
                          odometry.pose.theta_rad, odometry.linear_x_m_s, odometry.angular_z_rad_s,
                          collisions ? fmt::to_string(*collisions) : "nan"));
  if (const TimeNs now = wall_now(); now - flushed_ >= kFlushPeriod) {
    file_.flush();
    flushed_ = now;
  }
}

void write_world(const std::string& directory, const vehicle::Vehicle& vehicle,
                 std::uint64_t seed) {
  const auto& arena = vehicle.arena();
  const auto start = vehicle.pose();
  const auto scan = vehicle.scan();
  nlohmann::json world{
      {"world", vehicle.world()},
      {"seed", seed},
      {"arena",
       {{"min_x_m", arena.min_x_m},
        {"min_y_m", arena.min_y_m},
        {"max_x_m", arena.max_x_m},
        {"max_y_m", arena.max_y_m},
        {"wall_height_m", wall_height_m(vehicle.model(), vehicle.data(), arena)}}},
      {"start", {{"x_m", start.x_m}, {"y_m", start.y_m}, {"theta_rad", start.theta_rad}}},
      {"vehicle_radius_m", vehicle.radius_m()},
      {"vehicle_height_m", vehicle_height_m(vehicle.model(), vehicle.data())},
      {"laser",
       {{"beams", scan.ranges_m.size()},
        {"angle_min_rad", scan.angle_min_rad},
        {"angle_increment_rad", scan.angle_increment_rad}}},
      {"lamps", lamps_of(vehicle.model(), vehicle.data())},
      {"goals", describe(vehicle.goals())},
      {"lanes", describe(vehicle.lanes())},
      {"obstacles", describe(vehicle.obstacles())}};
  if (vehicle.cue_place() > 0) world["cue_place"] = vehicle.cue_place();
  write_file(in_directory(directory, "world.json"), world.dump(2) + "\n");
}

nlohmann::json summary_of(const vehicle::Simulation& robot) {
  if (robot.vehicle() == nullptr) return nlohmann::json::object();
  const vehicle::Statistics statistics = robot.vehicle()->statistics();
  return {{"collisions", statistics.collisions},
          {"distance_m", statistics.distance_m},
          {"coverage", statistics.coverage},
          {"mean_speed_m_s", statistics.mean_speed_m_s}};
}

}  // namespace spikeloop::robot
