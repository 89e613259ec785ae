// An MJCF world in memory, and the things in it that Spikeloop needs, found by their names.
#pragma once

#include <mujoco/mujoco.h>

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "spikeloop/core/error.hpp"
#include "spikeloop/vehicle/vehicle.hpp"

namespace spikeloop::vehicle {

struct MjDelete {
  void operator()(mjModel* model) const { mj_deleteModel(model); }
  void operator()(mjData* data) const { mj_deleteData(data); }
};
using ModelPointer = std::unique_ptr<mjModel, MjDelete>;
using DataPointer = std::unique_ptr<mjData, MjDelete>;

/// Reads an MJCF file; spikeloop_vehicle.xml can be included from anywhere.
/// @throws FileError, ConfigurationError with MuJoCo's own message.
ModelPointer load_model(const std::string& path);

/// Names of a world. Every method throws ConfigurationError with the world's path and what to
/// write when the thing is missing or malformed.
class Names {
 public:
  Names(const mjModel& model, std::string path) : model_(&model), path_(std::move(path)) {}

  int find(mjtObj type, std::string_view kind, const std::string& name,
           std::string_view remedy) const;
  /// Numbers of `<numeric name= data=>`, from -1e9 to 1e9. nullopt if there is none of that name.
  std::optional<std::vector<double>> numeric(const std::string& name, std::size_t count,
                                             std::string_view meaning) const;
  std::vector<double> required_numeric(const std::string& name, std::size_t count,
                                       std::string_view meaning) const;
  double number(const std::string& name, double default_value, std::string_view meaning) const;
  /// Line of the data of a numeric, as far as it is known.
  Location where(const std::string& numeric) const;
  std::string body(int id) const { return text(mj_id2name(model_, mjOBJ_BODY, id)); }
  std::string geom(int id) const { return text(mj_id2name(model_, mjOBJ_GEOM, id)); }
  std::string joint(int id) const { return text(mj_id2name(model_, mjOBJ_JOINT, id)); }
  std::string site(int id) const { return text(mj_id2name(model_, mjOBJ_SITE, id)); }
  const std::string& path() const { return path_; }

 private:
  static std::string text(const char* name) { return name == nullptr ? std::string() : name; }
  const mjModel* model_;
  std::string path_;
};

/// The group that the vehicle's geoms get: rays and beams do not see it.
inline constexpr int kVehicleGroup = mjNGROUP - 1;
inline constexpr mjtByte kAllButVehicle[mjNGROUP] = {1, 1, 1, 1, 1, 0};

/// The vehicle's parts in a model.
struct Parts {
  static constexpr int kWheels = 4;  ///< front left, front right, rear left, rear right
  int body = -1;
  int qpos = -1;  ///< address of the free joint's 7 positions
  int qvel = -1;  ///< address of the free joint's 6 velocities
  int site = -1;
  int floor = -1;
  std::array<int, kWheels> joint{};
  std::array<int, kWheels> actuator{};
  double wheel_radius_m = 0;
  double half_effective_track_m = 0;
  double radius_m = 0;
  std::vector<bool> own_geom;  ///< for each geom: part of the vehicle?
};

Parts find_parts(const mjModel& model, const Names& names);

}  // namespace spikeloop::vehicle
