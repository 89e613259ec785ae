#include "scene.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "spikeloop/core/code.hpp"
#include "spikeloop/core/error.hpp"

namespace spikeloop::pictures {
namespace {

constexpr double kTrailStep = 0.03;         // m
constexpr std::size_t kTrailPoints = 3000;  // then every second one is left out
constexpr float kTrailColour[4] = {0.86F, 0.20F, 0.16F, 1.0F};
constexpr double kTrailHeight = 0.004;  // m above the floor
constexpr double kTrailWidth = 4;       // pixels
constexpr int kGeoms = 2000;            // beside the trail
constexpr double kElevation = -68;      // degrees: the floor is seen, and the things' sides
constexpr double kDegree = std::numbers::pi / 180;

}  // namespace

int camera_id(const vehicle::Simulation& robot, const std::string& name) {
  const int camera = mj_name2id(&robot.model(), mjOBJ_CAMERA, name.c_str());
  if (camera < 0) {
    const auto known = robot.names_of(vehicle::Named::camera);
    if (const std::string meant = nearest(name, known); !meant.empty()) {
      throw ConfigurationError(
          Location{robot.world()},
          with_code(Code::world, "has no camera '{}'; did you mean '{}'?", name, meant));
    }
    throw ConfigurationError(
        Location{robot.world()},
        with_code(Code::world,
                  "has no camera '{0}'; write <camera name=\"{0}\" pos=\"0.2 0 0.07\" "
                  "xyaxes=\"0 -1 0 0 0 1\"/> into body '{1}'{2}",
                  name, robot.vehicle() != nullptr ? "vehicle" : "...",
                  robot.vehicle() != nullptr ? ", or include the shipped vehicle" : ""));
  }
  return camera;
}

void State::take(const vehicle::Simulation& robot) {
  const mjModel& model = robot.model();
  const mjData& data = robot.data();
  time = robot.time();
  if (const vehicle::Vehicle* const vehicle = robot.vehicle()) {
    pose = vehicle->pose();
  }
  qpos.assign(data.qpos, data.qpos + model.nq);
  mocap_pos.assign(data.mocap_pos, data.mocap_pos + 3 * model.nmocap);
  mocap_quat.assign(data.mocap_quat, data.mocap_quat + 4 * model.nmocap);
}

void Trail::go_on(const std::optional<vehicle::Pose>& pose) {
  if (!pose || (!points_.empty() && std::hypot(pose->x_m - points_.back()[0],
                                               pose->y_m - points_.back()[1]) < kTrailStep)) {
    return;
  }
  if (points_.size() == kTrailPoints) {
    for (std::size_t i = 0; 2 * i < points_.size(); ++i) points_[i] = points_[2 * i];
    points_.resize(kTrailPoints / 2);
  }
  points_.push_back({pose->x_m, pose->y_m});
}

Scene::Scene(const vehicle::Simulation& robot, const SceneOptions& options)
    : model_(mj_copyModel(nullptr, &robot.model())) {
  if (const vehicle::Vehicle* const vehicle = robot.vehicle()) {
    arena_ = vehicle->arena();
  }
  model_->vis.global.offwidth = static_cast<int>(options.buffer.width);
  model_->vis.global.offheight = static_cast<int>(options.buffer.height);
  model_->vis.quality.offsamples = options.samples;
  if (!options.shadows) model_->vis.quality.shadowsize = 0;
  data_.reset(mj_makeData(model_.get()));
  mjv_defaultOption(&option_);
  std::fill_n(option_.geomgroup, mjNGROUP, 1);
  option_.geomgroup[3] = option_.geomgroup[4] = 0;  // by custom, what only collides
  std::fill_n(option_.sitegroup, mjNGROUP, 0);
  mjv_defaultScene(&scene_);
  mjr_defaultContext(&context_);
  mjv_makeScene(model_.get(), &scene_, kGeoms + static_cast<int>(kTrailPoints));
  scene_.flags[mjRND_SHADOW] = options.shadows;
  scene_.flags[mjRND_REFLECTION] = options.shadows;
  try {
    mjr_makeContext(model_.get(), &context_, mjFONTSCALE_100);
  } catch (const Error& error) {
    mjv_freeScene(&scene_);
    throw TransportError(fmt::format("cannot draw: {}; is libgl1 installed?", error.what()));
  }
  mjr_setBuffer(mjFB_OFFSCREEN, &context_);
  set(State(robot));
}

Scene::~Scene() {
  mjr_freeContext(&context_);
  mjv_freeScene(&scene_);
}

void Scene::set(const State& state) {
  std::ranges::copy(state.qpos, data_->qpos);
  std::ranges::copy(state.mocap_pos, data_->mocap_pos);
  std::ranges::copy(state.mocap_quat, data_->mocap_quat);
  mj_kinematics(model_.get(), data_.get());
  mj_comPos(model_.get(), data_.get());
  mj_camlight(model_.get(), data_.get());
  pose_ = state.pose;
}

mjvCamera Scene::camera(View view, double aspect) const {
  mjvCamera camera;
  mjv_defaultCamera(&camera);
  camera.type = mjCAMERA_FREE;
  if (!arena_) {
    mjv_defaultFreeCamera(model_.get(), &camera);
  } else if (view == View::above) {
    const double half_height = 0.5 * (arena_->max_y_m - arena_->min_y_m);
    const double half_width = 0.5 * (arena_->max_x_m - arena_->min_x_m);
    const double tangent = std::tan(0.5 * model_->vis.global.fovy * kDegree);
    // Room for the walls, and for the near edge, which is larger than the far one.
    camera.distance = 1.22 * std::max(half_height, half_width / aspect) / tangent;
    camera.lookat[0] = 0.5 * (arena_->max_x_m + arena_->min_x_m);
    camera.lookat[1] = 0.5 * (arena_->max_y_m + arena_->min_y_m);
    camera.lookat[2] = 0;
    camera.azimuth = 90;
    camera.elevation = kElevation;
  } else {
    camera.distance = 1.3;
    camera.elevation = -28;
    follow(view, camera);
  }
  return camera;
}

void Scene::follow(View view, mjvCamera& camera) const {
  if (view != View::chase || !pose_) return;
  camera.lookat[0] = pose_->x_m + 0.25 * std::cos(pose_->theta_rad);
  camera.lookat[1] = pose_->y_m + 0.25 * std::sin(pose_->theta_rad);
  camera.lookat[2] = 0.1;
  camera.azimuth = pose_->theta_rad / kDegree;
}

void Scene::draw(mjrRect where, mjvCamera& camera, const Trail* trail) {
  mjv_updateScene(model_.get(), data_.get(), &option_, nullptr, &camera, mjCAT_ALL, &scene_);
  if (trail != nullptr) add(*trail);
  mjr_render(where, &scene_, &context_);
}

void Scene::draw_camera(mjrRect where, int id, double tangent) {
  mjvCamera camera;
  mjv_defaultCamera(&camera);
  camera.type = mjCAMERA_FIXED;
  camera.fixedcamid = id;
  mjv_updateScene(model_.get(), data_.get(), &option_, nullptr, &camera, mjCAT_ALL, &scene_);
  for (mjvGLCamera& eye : scene_.camera) {
    const double half = tangent * eye.frustum_near * where.height / where.width;
    eye.frustum_top = static_cast<float>(half);
    eye.frustum_bottom = static_cast<float>(-half);
    eye.frustum_center = 0;
  }
  mjr_render(where, &scene_, &context_);
}

void Scene::add(const Trail& trail) {
  const auto& points = trail.points();
  for (std::size_t i = 1; i < points.size() && scene_.ngeom < scene_.maxgeom; ++i) {
    mjvGeom& line = scene_.geoms[scene_.ngeom++];
    mjv_initGeom(&line, mjGEOM_LINE, nullptr, nullptr, nullptr, kTrailColour);
    mjv_makeConnector(&line, mjGEOM_LINE, kTrailWidth, points[i - 1][0], points[i - 1][1],
                      kTrailHeight, points[i][0], points[i][1], kTrailHeight);
    line.category = mjCAT_DECOR;
    line.emission = 0.6F;
  }
}

void Scene::write(mjrRect where, const std::string& text) {
  mjr_overlay(mjFONT_NORMAL, mjGRID_TOPLEFT, where, text.c_str(), nullptr, &context_);
}

void Scene::read(Image& image) {
  const auto width = static_cast<std::size_t>(image.size.width);
  const auto height = static_cast<std::size_t>(image.size.height);
  image.rgb.resize(3 * width * height);
  mjr_readPixels(image.rgb.data(), nullptr,
                 {0, 0, static_cast<int>(width), static_cast<int>(height)}, &context_);
  for (std::size_t row = 0; row < height / 2; ++row) {  // OpenGL begins with the lowest row
    std::swap_ranges(
        image.rgb.begin() + static_cast<std::ptrdiff_t>(3 * width * row),
        image.rgb.begin() + static_cast<std::ptrdiff_t>(3 * width * (row + 1)),
        image.rgb.begin() + static_cast<std::ptrdiff_t>(3 * width * (height - 1 - row)));
  }
}

}  // namespace spikeloop::pictures
