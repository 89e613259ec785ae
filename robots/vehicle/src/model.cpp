#include "model.hpp"

#include "model_files.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <mutex>
#include <regex>

#include "spikeloop/core/code.hpp"
#include "spikeloop/core/error.hpp"
#include "spikeloop/core/file.hpp"
#include "spikeloop/core/log.hpp"
#include "spikeloop/processes/trial.hpp"

namespace spikeloop::vehicle {
namespace {

constexpr const char* kVehicleFile = "spikeloop_vehicle.xml";
constexpr const char* kLookFile = "spikeloop_look.xml";
constexpr const char* kInclude =
    "include the shipped vehicle: <include file=\"spikeloop_vehicle.xml\"/>";

// MuJoCo's own handlers write MUJOCO_LOG.TXT into the working directory and end the process.
void install_handlers() {
  static std::once_flag once;
  std::call_once(once, [] {
    mju_user_warning = [](const char* text) { log::warning("MuJoCo: {}", text); };
    mju_user_error = [](const char* text) {
      throw NodeError("robot", fmt::format("MuJoCo stopped: {}", text));
    };
  });
}

struct VfsDelete {
  void operator()(mjVFS* vfs) const {
    mj_deleteVFS(vfs);
    delete vfs;
  }
};

// A table of virtual files that holds the shipped vehicle and look, unless the world has its own
// beside it.
std::unique_ptr<mjVFS, VfsDelete> shipped_files(const std::filesystem::path& world) {
  std::unique_ptr<mjVFS, VfsDelete> files(new mjVFS);
  mj_defaultVFS(files.get());
  for (const char* name : {kVehicleFile, kLookFile}) {
    if (std::filesystem::exists(world.parent_path() / name)) continue;
    const std::filesystem::path shipped = find_world(name);
    // With a directory given apart, MuJoCo 2.2.2 does not find the file.
    if (mj_addFileVFS(files.get(), nullptr, shipped.c_str()) != 0) {
      throw FileError("read", shipped.string(), EIO);
    }
  }
  return files;
}

[[noreturn]] void throw_not_mjcf(const std::string& path, const std::string& reason) {
  Location where{path};
  std::smatch match;
  if (std::regex_search(reason, match, std::regex("line (\\d+)"))) {
    where.line = std::stoi(match[1]);
  }
  throw ConfigurationError(
      where, with_code(Code::world, "MuJoCo {} cannot read it: {}", mj_versionString(), reason));
}

double circle_of(const mjModel& model, int geom) {
  const mjtNum* size = model.geom_size + 3 * geom;
  switch (model.geom_type[geom]) {
    case mjGEOM_BOX:
      return std::hypot(size[0], size[1]);
    case mjGEOM_CYLINDER:
      return size[0];
    default:
      return model.geom_rbound[geom];
  }
}

// Positions of a wheel's parts are within the vehicle's own frame as long as it stands at rest.
bool belongs_to(const mjModel& model, int body, int ancestor) {
  while (body > 0 && body != ancestor) body = model.body_parentid[body];
  return body == ancestor;
}

double vehicle_radius(const mjModel& model, const Parts& parts) {
  double radius = 0;
  for (int geom = 0; geom < model.ngeom; ++geom) {
    if (!parts.own_geom[static_cast<std::size_t>(geom)]) continue;
    const int body = model.geom_bodyid[geom];
    const mjtNum* offset = model.geom_pos + 3 * geom;
    if (body == parts.body) {
      radius = std::max(radius, std::hypot(offset[0], offset[1]) + circle_of(model, geom));
    } else {
      // A wheel: a disc standing upright, its hinge along y. Its corner is farthest away.
      const mjtNum* at = model.body_pos + 3 * body;
      const mjtNum* size = model.geom_size + 3 * geom;
      radius = std::max(radius, std::hypot(std::abs(at[0]) + size[0], std::abs(at[1]) + size[1]));
    }
  }
  return radius;
}

void find_wheels(const mjModel& model, const Names& names, Parts& parts) {
  const std::array<std::string, Parts::kWheels> wheels{"wheel_front_left", "wheel_front_right",
                                                       "wheel_rear_left", "wheel_rear_right"};
  double moment = 0;
  double lever = 0;
  for (std::size_t i = 0; i < wheels.size(); ++i) {
    const int joint = names.find(mjOBJ_JOINT, "joint", wheels[i], kInclude);
    parts.joint[i] = joint;
    parts.actuator[i] = names.find(mjOBJ_ACTUATOR, "actuator", wheels[i], kInclude);
    const int body = model.jnt_bodyid[joint];
    if (model.body_geomnum[body] == 0) {
      throw ConfigurationError(Location{names.path()},
                               with_code(Code::world, "joint '{}' turns a body without a geom; {}",
                                         wheels[i], kInclude));
    }
    const mjtNum* at = model.body_pos + 3 * body;
    moment += at[0] * at[0] + at[1] * at[1];
    lever += std::abs(at[1]);
    parts.wheel_radius_m = model.geom_size[3 * model.body_geomadr[body]];
  }
  parts.half_effective_track_m = moment / lever;
}

}  // namespace

namespace {

using Reason = std::array<char, 1000>;

constexpr int kTrialSteps = 100;  // until the wheels touch the floor
constexpr double kLargestNumber = 1e9;
constexpr std::size_t kNumbersShown = 10;

ModelPointer read_model(const std::string& path, Reason& reason) {
  const auto files = shipped_files(path);
  return ModelPointer(
      mj_loadXML(path.c_str(), files.get(), reason.data(), static_cast<int>(reason.size())));
}

/// MuJoCo crashes on some files and hangs on others, while loading or stepping. Allocate mjData
/// twice, as Simulation does.
void try_model(const std::string& path) {
  try_in_a_copy(path, "MuJoCo", [&] {
    Reason reason{};
    const ModelPointer model = read_model(path, reason);
    mjData* const data = model ? mj_makeData(model.get()) : nullptr;
    [[maybe_unused]] mjData* const second = data ? mj_makeData(model.get()) : nullptr;
    for (int i = 0; data != nullptr && i < kTrialSteps; ++i) {
      mj_step(model.get(), data);
    }
  });
}

}  // namespace

ModelPointer load_model(const std::string& path) {
  install_handlers();
  require_regular_file(path, "world");
  check_numbers(read_model_files(path));
  try_model(path);
  Reason reason{};
  ModelPointer model = read_model(path, reason);
  if (!model) {
    std::string text(reason.data());
    std::replace(text.begin(), text.end(), '\n', ' ');
    throw_not_mjcf(path, text);
  }
  if (reason[0] != '\0') log::warning("{}: {}", path, reason.data());
  return model;
}

int Names::find(mjtObj type, std::string_view kind, const std::string& name,
                std::string_view remedy) const {
  const int id = mj_name2id(model_, type, name.c_str());
  if (id < 0) {
    throw ConfigurationError(Location{path_},
                             with_code(Code::world, "has no {} '{}'; {}", kind, name, remedy));
  }
  return id;
}

std::optional<std::vector<double>> Names::numeric(const std::string& name, std::size_t count,
                                                  std::string_view meaning) const {
  const int id = mj_name2id(model_, mjOBJ_NUMERIC, name.c_str());
  if (id < 0) return std::nullopt;
  const mjtNum* data = model_->numeric_data + model_->numeric_adr[id];
  std::vector<double> values(data, data + model_->numeric_size[id]);
  if (values.size() != count) {
    values.resize(std::min(values.size(), kNumbersShown));
    throw ConfigurationError(
        where(name), with_code(Code::world, "numeric '{}' is \"{}\"; write {} numbers: {}", name,
                               fmt::join(values, " "), count, meaning));
  }
  for (const double value : values) {
    if (!(std::abs(value) <= kLargestNumber)) {
      throw ConfigurationError(
          where(name),
          with_code(Code::world,
                    "numeric '{}' has the number {}; write {} numbers from {:g} to {:g}: {}", name,
                    value, count, -kLargestNumber, kLargestNumber, meaning));
    }
  }
  return values;
}

Location Names::where(const std::string& numeric) const {
  const Location place = find_attribute(read_model_files(path_), "numeric", "data", numeric);
  return place.line > 0 ? place : Location{path_};
}

std::vector<double> Names::required_numeric(const std::string& name, std::size_t count,
                                            std::string_view meaning) const {
  auto values = numeric(name, count, meaning);
  if (!values) {
    throw ConfigurationError(
        Location{path_},
        with_code(Code::world,
                  "has no numeric '{0}'; write <custom><numeric name=\"{0}\" data=\"...\"/>"
                  "</custom> with {1} numbers: {2}",
                  name, count, meaning));
  }
  return *values;
}

double Names::number(const std::string& name, double default_value,
                     std::string_view meaning) const {
  const auto values = numeric(name, 1, meaning);
  return values ? (*values)[0] : default_value;
}

Parts find_parts(const mjModel& model, const Names& names) {
  Parts parts;
  parts.body = names.find(mjOBJ_BODY, "body", "vehicle", kInclude);
  const int joint = model.body_jntadr[parts.body];
  if (joint < 0 || model.jnt_type[joint] != mjJNT_FREE) {
    throw ConfigurationError(
        Location{names.path()},
        with_code(
            Code::world,
            "body 'vehicle' has no free joint; write <freejoint/> in it, or include the shipped "
            "vehicle: <include file=\"spikeloop_vehicle.xml\"/>"));
  }
  parts.qpos = model.jnt_qposadr[joint];
  parts.qvel = model.jnt_dofadr[joint];
  parts.site = names.find(mjOBJ_SITE, "site", "laser", kInclude);
  parts.floor = names.find(mjOBJ_GEOM, "geom", "floor",
                           "write <geom name=\"floor\" type=\"plane\" size=\"4 4 0.1\"/>");
  parts.own_geom.resize(static_cast<std::size_t>(model.ngeom));
  for (int geom = 0; geom < model.ngeom; ++geom) {
    parts.own_geom[static_cast<std::size_t>(geom)] =
        belongs_to(model, model.geom_bodyid[geom], parts.body);
  }
  find_wheels(model, names, parts);
  parts.radius_m = vehicle_radius(model, parts);
  return parts;
}

}  // namespace spikeloop::vehicle
